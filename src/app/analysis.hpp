// The results of `analyze`, and their forms: JSON, CSV, tables, plot.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/impact/compare_resistances.hpp>
#include <stillbase/impact/indices.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase::app {

/// One impact by its direction in the xy plane of B, deg from x about z, [0, 360).
struct AnalysisRow {
  double direction_deg = 0;
  ImpactSummary impact;
};

struct AnalysisComparison {
  bool is_illustrative = false;  ///< the resistance's values are not the problem's
  ImpactSummary impact;
};

/// The posture without any particular impulse, under the problem's joint resistance.
struct PostureIndices {
  Ellipsoid impulse;  ///< against a target that cannot be moved
  BaseReactionEllipsoid reaction;
  FavourableDirections favourable_in_plane, favourable_in_space;
  CaseDirections zero_in_plane, zero_in_space;
  GeneralizedJacobianIndices jacobian;
  DynamicCoupling coupling;
};

struct Analysis {
  std::string problem;  ///< its name
  RobotModel robot;
  std::vector<AnalysisRow> rows;
  std::vector<AnalysisComparison> resistances;  ///< in the problem's own direction
  PostureIndices posture;
};

/// The impact in the start posture, in the stated direction (directions = 0) or in many, evenly
/// around the base's z axis from x.
/// @throws CommandLineError when a sweep is asked of a problem that states no direction
Analysis analyse(const CaptureProblem& problem, int directions);

std::string analysis_json(const Analysis& analysis);
std::string analysis_csv(const Analysis& analysis);
std::string analysis_words(const Analysis& analysis);

/// Two panels over the direction, as Figs. 4 and 5 of the paper: the three momenta with their zero
/// line and marks at the zero directions; the norm of the joint rates with its two parts. Momenta
/// about z where all of them are (planar robots), else their norms.
/// @throws CommandLineError unless there are two rows or more
std::string analysis_svg(const Analysis& analysis);

}  // namespace stillbase::app
