// Geometric planning from a start to any of several goals, by name. Knows neither robots nor
// scenes.
//
// Every goal has its own obstacles, called its world here. A path leads through the world of the
// goal at which it ends.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <stillbase/approach/options.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/core/types.hpp>

namespace stillbase {

struct PathEnds {
  JointVectord start, goal;  ///< inside the bounds, valid, finite
  double weight = 1;  ///< > 0; how often this goal's world is sampled, relative to the others
};

struct PathQuery {
  std::vector<PathEnds> ends;  ///< at least one; the best one first
  JointVectord lower, upper;   ///< lower < upper, finite
  double resolution = 0.02;    ///< rad between checked postures
  std::uint64_t seed = 1;
  int max_iterations = 20000;
  StopCondition stop;
  PathPlannerOptions options;
  /// In the world of a goal (index in `ends`).
  std::function<bool(std::size_t, const JointVectord&)> is_valid;
  /// On the straight line between two valid postures.
  std::function<bool(std::size_t, const JointVectord&, const JointVectord&)> is_motion_valid;

  /// OMPL takes NaN for a valid state, and NaN bounds end the process.
  /// @throws std::invalid_argument for numbers that are not finite or bounds that are empty
  void check() const;
};

enum class PathOutcome { Found, NotFound, Stopped };

struct PathAnswer {
  PathOutcome outcome = PathOutcome::NotFound;
  std::size_t reached = 0;           ///< index in `ends`
  std::vector<JointVectord> points;  ///< waypoints with start and goal, joined by straight lines
};

using PathPlanner = std::function<PathAnswer(const PathQuery&)>;

/// The planner of this name; empty when there is none.
PathPlanner find_path_planner(const std::string& name);

/// A rough path within the reaction null space, for curves to follow: postures from the start to
/// one within `guide_ends` of the goal, found by OMPL's RRT over joint velocities. Empty: none.
/// @param query with one goal; is_motion_valid and resolution are not used
/// @param projected velocity in the null space nearest to a wanted one, at a posture
std::vector<JointVectord> find_guide(
    const PathQuery& query, const NullSpaceOptions& options,
    const std::function<JointVectord(const JointVectord&, const JointVectord&)>& projected);

}  // namespace stillbase
