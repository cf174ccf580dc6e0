// How good is the instantaneous impact? A contact that takes time beside it, over its stiffness.
#pragma once

#include <stillbase/simulation/contact.hpp>

namespace stillbase {

/// A robot at rest (or moving) with a target that is about to touch its hand. The target's position
/// is put so that its contact point is at the hand.
struct ModelCheckCase {
  RobotModel robot;
  PlantState before;
  JointResistance resistance;  ///< servo: stiffness and damping act during the contact
  EncounterPlant target;       ///< mass and inertia are used
  TargetPlantState target_state;
  Vector3d point_T = Vector3d::Zero(), normal_T = Vector3d::UnitX();  ///< of the contact
  double restitution = 1;                                             ///< in [kLeastRestitution, 1]
  double friction = 0;  ///< of the compliant contact; the jump has none
};

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

/// One row per stiffness (N/m). Damping follows from the restitution.
/// @throws InputError, std::invalid_argument as simulate_encounter() and contact_damping()
std::vector<ModelCheckRow> check_stiffness(const ModelCheckCase& subject,
                                           const std::vector<double>& stiffness,
                                           const StopCondition& stop = {});

}  // namespace stillbase
