// The motion from the contact of hand and target on, by one of the models of the contact.
//
// Assumptions: the robot waits in its posture; the contact point is the origin of the hand frame. A
// compliant contact begins one control period (10 ms at most) before time zero, on which the target
// moves uniformly, so that both bodies touch at time zero. A latch closes at time zero.
#pragma once

#include <stillbase/impact/contact.hpp>
#include <stillbase/simulation/contact.hpp>
#include <stillbase/simulation/latch.hpp>

namespace stillbase {

/// The target at the contact.
struct MetTarget {
  TargetBody body;
  TargetPlantState state;  ///< at the contact, where its contact point is at the hand
};

struct ContactCase {
  RobotModel robot;
  JointResistance resistance;
  PlantState before;         ///< of the robot that waits
  PlantState after;          ///< right after the instantaneous impact
  double impulse = 0;        ///< of the contact law with free joints' resistance as stated, N s
  double closing_speed = 0;  ///< m/s
  double restitution = 0;
  Vector3d normal_N = Vector3d::UnitX();  ///< of the impulse on the hand, unit
  std::optional<MetTarget> target;        ///< needed for all but ContactModel::Jump
};

struct ContactChoice {
  ContactModel model = ContactModel::Jump;
  double stiffness = 1e5;         ///< Compliant: N/m
  std::optional<double> damping;  ///< Compliant: N s/m; empty: leaves the case's restitution
  double friction = 0;            ///< Compliant
  double target_scale = 1;  ///< Latch: mass and inertia of the target in the controller's model
};

struct AfterContact {
  SimulationResult simulation;
  RobotModel robot;  ///< of the simulation: with the target when it is held
  /// Compliant. separation_speed is that at the end of the first contact.
  std::optional<EncounterResult> encounter;
  bool is_held = false;                       ///< Latch
  Vector6d latch_impulse = Vector6d::Zero();  ///< Latch: on the hand, [f; t] in B, N s, N m s
};

/// Runs the case from the contact to the horizon. Without a contact (impulse zero) the robot
/// continues from `after`.
/// @param options its controller's robot is that without a target; start_time must be zero
/// @throws InputError when sizes or options make no sense, std::invalid_argument when the model
///   needs a target and there is none, or a compliant contact has to leave less than
///   kLeastRestitution
[[nodiscard]] AfterContact simulate_after_contact(const ContactCase& subject,
                                                  const ContactChoice& choice,
                                                  const Controller& controller,
                                                  const SimulationOptions& options);

}  // namespace stillbase
