// The base pose along an approach, integrated from the momentum equation by `reference`.
#pragma once

#include <functional>

#include "verification/joint_motion.hpp"

namespace stillbase::verification {

/// Base velocity of a robot without momentum: Omega = -H_b^-1 H_bphi phidot.
Vector6d drifting_base_velocity(const RobotModel& robot, const Eigen::VectorXd& phi,
                                const Eigen::VectorXd& phidot);

/// Pose of the base after [s0, s1] of a segment, from the pose at s0. Classical Runge-Kutta on
/// position and Euler parameters, in equal steps of at most a quarter of the segment, within which
/// no joint moves further than `max_travel` (rad or m).
Pose drifted_base(const RobotModel& robot, const HermiteSegment& segment, double s0, double s1,
                  const Pose& from, double max_travel);

}  // namespace stillbase::verification
