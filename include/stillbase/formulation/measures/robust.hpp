// The worst case over a cone of impulse directions.
//
// Hand and posture fixed; the direction varies within the cone about the nominal one, and the
// impulse is recomputed by the contact law for every direction. The maximum can lie inside the
// cone.
//
// Of a problem with a residual velocity the worst case is that over its ellipsoid instead, with all
// functions of this header; its scenarios have velocity errors and the nominal direction.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <stillbase/formulation/formulation.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// How the maxima over the cone are searched for: a scan, then a climb from its peaks, places with
/// no larger neighbour.
struct ConeScan {
  int rings = 12, spokes = 36;  ///< between the axis and the rim
  int row = 97;                 ///< places in a wedge, which is one-dimensional: finer for less
  std::size_t climbs = 6;       ///< at most, from peaks a quarter of the half-angle apart
};
/// The same where |y| has to be simulated: a direction costs as much as all the others together.
inline constexpr ConeScan kSimulatedScan{3, 12, 17, 3};

struct WorstCase {
  double value = 0;                       ///< the objective's largest value over the cone
  Vector3d direction = Vector3d::Zero();  ///< where, unit, in B; the normal without a cone
  /// False: simulations were given up before (Formulation::give_up_simulations_at); the largest
  /// over the directions seen, the nominal one among them.
  bool is_complete = true;
};

/// The objective's largest value over the problem's uncertainty cone at a configuration. A scan of
/// rings (planar: of the wedge) followed by climbs from its peaks.
WorstCase worst_case(const CaptureProblem& problem, const Formulation& formulation,
                     const Configuration& configuration);

/// All maxima over the cone that the scan finds, the largest first, as scenarios with the
/// objective's value: where several are as large, each of them limits a better posture.
struct ConeMaximum {
  Scenario scenario;
  double value = 0;
};
std::vector<ConeMaximum> cone_maxima(const CaptureProblem& problem, const Formulation& formulation,
                                     const Configuration& configuration);

/// The maximum that each of these directions belongs to, in the same order.
std::vector<ConeMaximum> climb(const CaptureProblem& problem, const Formulation& formulation,
                               const Configuration& configuration,
                               const std::vector<Scenario>& from);

/// The residual velocity at a configuration, and where in its ellipsoid the worst case is.
/// @pre the problem states one
ResidualSummary summarize_residual(const CaptureProblem& problem, const Formulation& formulation,
                                   const Configuration& configuration);

/// Nominal size of each term of the objective, by name, in its own unit. Its simulations are
/// never given up.
std::map<std::string, double> objective_terms(const CaptureProblem& problem,
                                              const Formulation& formulation,
                                              const Configuration& configuration);

/// The objective's value at the nominal direction. Its simulations are never given up.
double nominal_value(const CaptureProblem& problem, const Formulation& formulation,
                     const Configuration& configuration);

}  // namespace stillbase
