// A robot on whose base nothing acts, from joint positions on.
#pragma once

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// Motion of the joints (n each).
struct JointRates {
  const JointVectord &phi, &phidot, &phiddot;
};

/// Base twist [v; omega] in B at which the robot has no momentum, (10).
Vector6d free_base_velocity(const RobotModel& robot, const JointVectord& phi,
                            const JointVectord& phidot);

/// Joint torques of a motion, (3), with the drives' reflected inertia (n), N m or N.
/// @param base_moves as the joints make it, without momentum; false: it is held at rest
JointVectord motion_torques(const RobotModel& robot, const JointRates& motion, bool base_moves);

}  // namespace stillbase
