// Paths within the angular reaction null space: the arm moves and the base does not turn.
//
// phi' = P(phi) w, P the projector onto the null space of Htilde_omegaphi (9). The directions that
// are open change with the posture, so that postures off the null space of the start are reached by
// going around (n > rank + 1). The path follows a reference curve as well as it may,
//   phi' = P(phi) (r' + kappa (r - phi)),
// and the knots of the curve are shifted by Newton steps of least norm until it ends at the goal.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <stillbase/approach/approach.hpp>

#include "approach/joint_path.hpp"
#include "approach/motion_check.hpp"
#include "approach/null_tracker.hpp"

namespace stillbase {

/// One of the goals, with its own obstacles.
struct NullGoal {
  JointVectord posture;  ///< n: the first end of the reference curve
  /// Configurations that solve the contact near a posture, and how good they are (smaller is
  /// better).
  std::function<std::optional<Configuration>(const JointVectord&, ContactSolve)> near;
  std::function<double(const Configuration&)> measure;
  /// Whether the robot can wait there while the target comes in.
  std::function<bool(const Configuration&)> can_wait;
  const StillScene* scene = nullptr;
};

struct NullPathQuery {
  JointVectord start;              ///< n
  std::vector<NullGoal> goals;     ///< at least one, the best one first
  std::vector<Eigen::Index> free;  ///< joints that may move; the others keep still
  JointVectord lower, upper;       ///< of the free joints, finite
  std::uint64_t seed = 1;
  int max_iterations = 0;  ///< of OMPL's planner
  StopCondition stop;
  NullSpaceOptions options;
};

struct NullPathAnswer {
  JointPath curve;    ///< over its length (rad), slopes of norm 1, to one of the goals. Empty: none
  Configuration end;  ///< where it ends
  std::size_t goal = 0;  ///< index of the goal that it headed for
  std::string detail;    ///< what was tried
  bool stopped = false;
};

/// Each curve is first brought to any posture that solves the contact, then its end is moved to
/// better ones as far as the curve can be bent. Of several curves the one with the best end is
/// kept. References are the straight line, then ever wider detours. When all of these collide, they
/// are paths around the obstacles that OMPL finds over joint velocities within the null space.
NullPathAnswer plan_null_path(const NullPathQuery& query, const CaptureProblem& problem);

}  // namespace stillbase
