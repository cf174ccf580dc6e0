// The motion from the contact of hand and target on: by the contact's law at once, or through a
// compliant contact.
//
// Assumptions: the robot waits in its posture, or moves without momentum where a rigid contact
// finds its hand moving (`closing_speed` is that of a hand at rest there too); the contact point is
// the origin of the hand frame. A compliant contact begins one control period (10 ms at most)
// before time zero, on which the target moves uniformly, so that both bodies touch at time zero. A
// latch closes at time zero.
#pragma once

#include <stillbase/impact/attach_target.hpp>
#include <stillbase/impact/contact_impulse.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/simulation/contact.hpp>

namespace stillbase {

/// The target at the contact.
struct TargetAtContact {
  TargetBody body;
  TargetPlantState state;  ///< at the contact, where its contact point is at the hand
};

struct ContactCase {
  RobotModel robot;
  JointResistance resistance;
  PlantState before;         ///< of the robot
  PlantState after;          ///< right after the instantaneous impact
  double impulse = 0;        ///< force part, by the contact law with the stated resistance, N s
  double closing_speed = 0;  ///< m/s
  ContactLaw law = ContactLaw::Frictionless;
  double restitution = 0;                 ///< Frictionless
  Vector3d normal_N = Vector3d::UnitX();  ///< of the contact, towards the hand; unit
  std::optional<TargetAtContact> target;  ///< needed by a latch and a compliant contact
  /// The target as the controllers know it after a latch; empty: as it is.
  std::optional<TargetBody> known_target = std::nullopt;
};

/// Whether hand and target meet: they close in, or a hand that moves with the target latches it,
/// which may take no impulse at all.
bool is_in_contact(const ContactCase& subject);

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
/// @param spec its contact, and the target in the controller's model
/// @param options its controller's robot is that without a target; start_time must be zero
/// @throws InputError when sizes or options make no sense, std::invalid_argument when the model
///   needs a target and there is none, a compliant contact has another law than Frictionless, or
///   has to leave less than kLeastRestitution
[[nodiscard]] AfterContact simulate_after_contact(const ContactCase& subject,
                                                  const PostImpactSpec& spec,
                                                  const Controller& controller,
                                                  const SimulationOptions& options);

/// simulate_after_contact() of each case, side by side where simulate_post_impacts() can.
/// @param options one per case
/// @throws as simulate_after_contact(); std::invalid_argument for another number of options
[[nodiscard]] std::vector<AfterContact> simulate_after_contacts(
    const std::vector<ContactCase>& subjects, const PostImpactSpec& spec,
    const Controller& controller, const std::vector<SimulationOptions>& options);

/// What the joints do after the horizon: where one still moves, the same run goes on to ten
/// horizons, or to the first joint that reaches its stop.
/// @param run of the same arguments
/// @return nothing when `run`, or its continuation, did not finish
/// @throws as simulate_after_contact()
[[nodiscard]] std::optional<AfterHorizon> look_beyond_horizon(const ContactCase& subject,
                                                              const PostImpactSpec& spec,
                                                              const Controller& controller,
                                                              const SimulationOptions& options,
                                                              const AfterContact& run);

struct LatchedRobot {
  RobotModel robot;        ///< robot and target as one, attach_target()
  PlantState state;        ///< right after the latch
  Pose hand_target;        ///< T in the hand frame, as it is held
  ContactImpulse impulse;  ///< on the hand; `robot` has the target only when its status is Hit
};

/// The rigid latch of the contact laws: all six relative velocities of hand and target vanish, and
/// the target stays. Momentum of the pair is that of the new robot; its matrices, reaction null
/// space and controllers include the target.
/// @param subject its `before` may move; of its contact law only the normal is used
/// @throws std::invalid_argument for a point mass or a target without mass
LatchedRobot latch_target(const ContactCase& subject);

/// A compliant contact beside the instantaneous impact.
struct ModelCheckRow {
  double stiffness = 0;   ///< of the contact, N/m
  bool ended = false;     ///< the contact was over in time
  double duration = 0;    ///< s
  double peak_force = 0;  ///< N
  /// Generalised velocity after the contact against that of the jump (6) with the resistance model
  /// of the case, the servo's with the duration found: |difference| in the norm of kinetic energy,
  /// relative to the jump itself.
  double velocity_error = 0;
  double free_error = 0;            ///< the same against the jump with free joints, no rotors
  double impulse_error = 0;         ///< normal impulse against the contact law's, relative
  double momentum_error = 0;        ///< of robot and target, see EncounterResult
  double kinetic_energy_after = 0;  ///< of robot and target, J
};

/// One row per stiffness (N/m). Damping follows from the restitution; a servo's stiffness and
/// damping act during the contact.
/// @param subject `after`, `impulse` and `closing_speed` are not used
/// @param friction of the compliant contact; the jump has none
/// @throws InputError, std::invalid_argument as simulate_encounter() and contact_damping()
std::vector<ModelCheckRow> check_stiffness(const ContactCase& subject, double friction,
                                           const std::vector<double>& stiffness,
                                           const StopCondition& stop = {});

}  // namespace stillbase
