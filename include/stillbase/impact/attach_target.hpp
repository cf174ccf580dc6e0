// After a latch the target stays attached: robot and target become one robot.
#pragma once

#include <stillbase/robot/robot_model.hpp>
#include <stillbase/target/target.hpp>

namespace stillbase {

/// The robot whose hand body includes the target: mass, centroid, inertia and shapes. Inertia
/// matrices, momentum, reaction null spaces and controllers of the result are those of robot +
/// target; joints, joint order and the hand frame stay where they were.
///
/// Where the hand is fixed to the base, the base body changes its centroid and with it the origin
/// of B: everything fixed to the base is expressed in the new B, and base poses and velocities
/// have to be moved there (base_shift()).
/// @param hand_target pose of the target frame T in the hand frame
/// @throws std::invalid_argument when the target's mass is not positive
RobotModel attach_target(RobotModel robot, const TargetBody& target, const Pose& hand_target);

/// The same with the poses at the contact: of the hand and of the target, in one common frame.
RobotModel attach_target(RobotModel robot, const Pose& hand, const TargetBody& target,
                         const Pose& target_pose);

/// Where attach_target() puts the origin of B, in the B of the robot without target, m. Zero unless
/// the hand is fixed to the base.
Vector3d base_shift(const RobotModel& robot, const TargetBody& target, const Pose& hand_target);

}  // namespace stillbase
