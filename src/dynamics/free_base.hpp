// Base motion without momentum, and joint torques with the base free or held, from joint positions
// on.
#pragma once

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// Omega = -H_b^-1 H_bphi phidot in B: the momenta P and L_g of (1) and (2) are zero.
Vector6d free_base_velocity(const RobotModel& robot, const JointVectord& phi,
                            const JointVectord& phidot);

/// Joint torques of a motion, (3), with the drives' reflected inertia (n), N m or N.
/// @param base_moves as the joints make it, without momentum; false: it is held at rest
JointVectord motion_torques(const RobotModel& robot, const JointVectord& phi,
                            const JointVectord& phidot, const JointVectord& phiddot,
                            bool base_moves);

}  // namespace stillbase
