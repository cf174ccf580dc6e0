// A grasp that closes at once: from then on robot and target are one robot.
#pragma once

#include <stillbase/impact/attach_target.hpp>
#include <stillbase/impact/contact_impulse.hpp>
#include <stillbase/simulation/plant.hpp>

namespace stillbase {

struct LatchedRobot {
  RobotModel robot;        ///< robot and target as one, attach_target()
  PlantState state;        ///< right after the latch
  Pose hand_target;        ///< T in the hand frame, as it is held
  ContactImpulse impulse;  ///< on the hand; `robot` is the target's only when its status is Hit
};

/// The rigid latch of the contact laws: all six relative velocities of hand and target vanish, and
/// the target stays. Momentum of the pair is that of the new robot; its matrices, reaction null
/// space and controllers include the target.
/// @param before robot right before the latch, target where it is at that instant
/// @param resistance during the latch; a rotor inertia stays in the plant
/// @throws std::invalid_argument for a point mass or a target without mass
LatchedRobot latch_target(const RobotModel& robot, const JointResistance& resistance,
                          const PlantState& before, const TargetBody& target,
                          const TargetPlantState& target_before, const Vector3d& normal_N);

}  // namespace stillbase
