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
  std::function<bool(std::size_t, const JointVectord&, const JointVectord&)>
      is_motion_valid;  ///< on the straight line between two valid postures
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

}  // namespace stillbase
