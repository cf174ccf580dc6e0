// A rough path around obstacles within the reaction null space, for curves to follow.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <stillbase/approach/options.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/core/types.hpp>

namespace stillbase {

struct GuideQuery {
  Eigen::VectorXd start, goal;   ///< m free joints, inside the bounds, valid
  Eigen::VectorXd lower, upper;  ///< finite
  std::uint64_t seed = 1;
  int max_iterations = 0;
  StopCondition stop;
  NullSpaceOptions options;
  std::function<bool(const Eigen::VectorXd&)> is_valid;
  /// Velocity in the null space nearest to a wanted one.
  std::function<Eigen::VectorXd(const Eigen::VectorXd& posture, const Eigen::VectorXd& wanted)>
      projected;
};

/// Postures from the start to one within `guide_ends` of the goal, found by OMPL's RRT over joint
/// velocities. Empty: none found.
std::vector<Eigen::VectorXd> find_guide(const GuideQuery& query);

}  // namespace stillbase
