// Geometric planning between two postures, by name. Knows neither robots nor scenes.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/core/types.hpp>

namespace stillbase {

struct PathQuery {
  JointVectord start, goal;   ///< inside the bounds, valid, finite
  JointVectord lower, upper;  ///< lower < upper, finite
  double resolution = 0.02;   ///< rad between checked postures
  std::uint64_t seed = 1;
  int max_iterations = 20000;
  StopCondition stop;
  std::function<bool(const JointVectord&)> is_valid;
  std::function<bool(const JointVectord&, const JointVectord&)>
      is_motion_valid;  ///< on the straight line between two valid postures
};

enum class PathOutcome { Found, NotFound, Stopped };

struct PathAnswer {
  PathOutcome outcome = PathOutcome::NotFound;
  std::vector<JointVectord> points;  ///< way points with start and goal, joined by straight lines
};

using PathPlanner = std::function<PathAnswer(const PathQuery&)>;

/// The planner of this name; empty when there is none.
PathPlanner find_path_planner(const std::string& name);

}  // namespace stillbase
