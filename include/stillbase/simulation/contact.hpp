// A contact that takes time: hand and target as two moving bodies with a spring-damper between
// them. An independent model to check the instantaneous jump by (PHYSICS section 3).
//
// Assumptions: the contact point is the origin of the hand frame and touches the plane through the
// target's contact point with the target's outward normal n; one contact point, no moment there.
// Gap g = n . (hand - contact point); while it is closed (g < 0)
//   f_n = max(0, -k g - d dg/dt) on the hand along n, the opposite on the target, and tangentially
//   f_t = -mu f_n v_t / max(|v_t|, slip_rate), v_t the tangential velocity of the hand against the
// target. (Coulomb friction, smoothed about zero slip: a contact of some milliseconds does not last
// long enough for the creep to matter.) The contact ends when the force would pull.
#pragma once

#include <optional>
#include <vector>

#include <stillbase/simulation/simulate.hpp>

namespace stillbase {

struct CompliantContact {
  double stiffness = 1e5;               ///< k, N/m, > 0
  double damping = 0;                   ///< d, N s/m, >= 0
  double friction = 0;                  ///< mu, >= 0
  double slip_rate = 1e-4;              ///< m/s
  Vector3d point = Vector3d::Zero();    ///< in T, m
  Vector3d normal = Vector3d::UnitX();  ///< outward, unit, in T
};

/// The drive of the joints while the contact lasts: tau = -K (phi - phi(0)) - D phidot. Ends with
/// the first contact. Empty vectors: none.
struct ContactServo {
  JointVectord stiffness, damping;  ///< n, N m/rad, N m s/rad
};

struct EncounterPlant {
  double mass = 0;                      ///< of the target, kg
  Matrix3d inertia = Matrix3d::Zero();  ///< in T, kg m^2; zero: a point mass, which does not rotate
  CompliantContact contact;
  ContactServo servo;
  JointVectord servo_posture;     ///< n; phi(0) of the servo
  bool end_with_contact = false;  ///< the run ends with the first contact
  bool is_point_mass() const { return inertia.isZero(0); }
};

enum class ContactPhase {
  Apart,  ///< a contact may begin
  Touching,
  Leaving  ///< no force, the spring is still pressed: until the gap opens or a force is back
};

struct ContactHistory {
  ContactPhase phase = ContactPhase::Apart;
  int contacts = 0;                   ///< begun
  double first_begin = 0;             ///< s
  bool has_separated = false;         ///< the force of the first one has ended, if only for a while
  double first_end = 0;               ///< s; of the force, the last one before the gap opens
  double first_separation_speed = 0;  ///< n . (v_hand - v_target) at that instant, m/s
};

/// The contact at one instant.
struct HandLoad {
  Vector3d force_N = Vector3d::Zero();  ///< on the hand at its origin, in N axes, N
  double normal_force = 0;              ///< k, d law without the cut at zero, N
  double gap = 0;                       ///< m
  double gap_rate = 0;                  ///< m/s
};

/// @param hand, hand_velocity of the hand's origin in N, m, m/s
HandLoad contact_load(const CompliantContact& contact, const TargetPlantState& target,
                      const Vector3d& hand, const Vector3d& hand_velocity);

/// The damping d with which the spring-damper leaves Newton's restitution e between two bodies with
/// effective mass m: d = 2 zeta sqrt(k m), zeta from x'' + 2 zeta x' + x = 0, x(0) = 0, x'(0) = 1,
/// up to the instant at which x + 2 zeta x' = 0, where x' = -e. e is never zero:
/// @param restitution e in [kLeastRestitution, 1]
/// @param effective_mass 1 / (n' W_h n + n' W_t n), kg
/// @throws std::invalid_argument outside that range
inline constexpr double kLeastRestitution = 1e-3;
double contact_damping(double restitution, double stiffness, double effective_mass);

/// The run and its contact.
struct EncounterResult {
  SimulationResult simulation;
  ContactHistory contact;
  TargetPlantState target_end;
  double separation_speed = 0;            ///< n . (v_hand - v_target) at the end, m/s; > 0: bounced
  Vector3d impulse_N = Vector3d::Zero();  ///< on the hand, from the target's momentum, N s
  /// Linear and angular momentum (about N's origin, over 1 m and the target's distance) of robot,
  /// wheels and target: change over the run, relative to the target's linear momentum.
  double momentum_error = 0;
};

/// Runs robot and target from shortly before the contact to horizon after the start: free motion,
/// contact(s) of finite duration, free motion.
/// @param resistance its rotor inertia is in the plant; servo and locks are not (ContactServo)
/// @throws InputError when sizes or options make no sense
[[nodiscard]] EncounterResult simulate_encounter(
    const RobotModel& robot, const JointResistance& resistance, const PlantState& robot_start,
    const TargetPlantState& target_start, const EncounterPlant& encounter,
    const Controller& controller, const SimulationOptions& options);

}  // namespace stillbase
