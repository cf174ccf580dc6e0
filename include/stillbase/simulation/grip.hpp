// The wrench through the grip of a held target: the rate of the target's momentum.
//
// Assumptions: the target is rigid and rigidly held; nothing else acts on it.
#pragma once

#include <optional>

#include <stillbase/impact/attach_target.hpp>
#include <stillbase/plan/post_impact.hpp>
#include <stillbase/simulation/plant.hpp>

namespace stillbase {

/// A target in the hand.
struct HeldTarget {
  TargetBody body;
  Pose hand_target;  ///< T in the hand frame
};

/// What is held, and what the grip can bear.
struct Grasp {
  GripSpec limits;
  std::optional<HeldTarget> target;
  /// As the controller knows it, when that is otherwise than it is; without mass: it knows of none.
  std::optional<HeldTarget> known;

  /// The target in the controller's model; null: there is none.
  const HeldTarget* known_target() const {
    if (known) return known->body.mass > 0 ? &*known : nullptr;
    return target ? &*target : nullptr;
  }
};

/// Wrench [f; t] that the hand gives the held target, at the hand's origin, in B, N, N m:
///   f = m dot v_c, t = I dot omega + omega x I omega + (c - h) x f,
/// c the target's centroid, h the hand. Affine in the acceleration.
/// @param robot with or without the target: only its tree matters
/// @param acceleration as compute_acceleration() has it
Vector6d grip_wrench(const HeldTarget& held, const RobotModel& robot,
                     const Kinematics<double>& kinematics, const PlantState& state,
                     const PlantAcceleration& acceleration);

}  // namespace stillbase
