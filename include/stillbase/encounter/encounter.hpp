// The encounter of hand and target: contact point, time, closing speed and impulse direction.
//
// Between a problem file and a plan the impulse direction has four representations:
//   1. ImpulseSpec::direction or ContactFeature::normal   as stated
//   2. EncounterModel::n, Scenario::direction             in the contact frame E, where the nominal
//                                                         direction is constant
//   3. Encounter::F                                       wrench per unit of impulse, in B, at one
//                                                         base attitude and contact time
//   4. ImpactSummary::Fbar                                the impulse in B, as the plan holds it
//
// Assumptions: the robot is at rest before the impact; the contact point is the origin of the hand
// frame; the target moves without torque. Templates take any number type with exact or enclosing
// arithmetic (src/encounter/encounter_kernel.hpp has their lines); verification and reference
// derive the encounter on their own.
#pragma once

#include <optional>
#include <utility>

#include <stillbase/impact/contact_impulse.hpp>
#include <stillbase/impact/contact_response.hpp>
#include <stillbase/impact/summary.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/plan/scenario.hpp>

namespace stillbase {

/// The frame E in which the nominal impulse direction is constant.
enum class ContactFrame { Base, Inertial, Target };

/// Two unit vectors u, v that complete the unit vector n to a right-handed basis (n, u, v).
std::pair<Vector3d, Vector3d> tangent_basis(const Vector3d& n);

/// What an encounter has in common at all postures, base attitudes and contact times.
struct EncounterModel {
  // Direction of the impulse on the hand.
  ContactFrame frame = ContactFrame::Base;
  Vector3d n = Vector3d::UnitX();      ///< nominal direction, unit, in E
  Vector3d u = Vector3d::UnitY();      ///< with v: tangents of n, in E
  Vector3d v = Vector3d::UnitZ();      ///< in E
  Vector3d moment = Vector3d::Zero();  ///< moment per unit of impulse, in E, m (Given only)

  // Contact law, see ImpulseSpec.
  ImpulseSource source = ImpulseSource::PointMass;
  ContactLaw law = ContactLaw::Frictionless;
  double magnitude = 1;      ///< N s (Given only)
  double restitution = 0;    ///< e
  double closing_speed = 0;  ///< m/s, with a stated direction

  // Motion of the hand before a rigid contact.
  MatchedPart matched = MatchedPart::None;
  ArrivalRates arrival_rates = ArrivalRates::LeastJointRate;
  Vector6d apart = Vector6d::Zero();  ///< decided velocity of the target less the hand's, in T

  // Target.
  /// Nominal motion, where the direction follows from the contact feature: E is T then.
  std::optional<TargetMotion> motion;
  TargetState first_state;                             ///< of `motion` at the earliest contact time
  Vector3d r = Vector3d::Zero();                       ///< contact feature in T, m
  double target_mass = kInfinity;                      ///< kg
  Matrix3d target_inertia = Matrix3d::Zero();          ///< in T, kg m^2; zero for a point mass
  Matrix3d target_inverse_inertia = Matrix3d::Zero();  ///< in T; zero for a point mass

  // Where the hand must be, and how it must be oriented.
  std::optional<Vector3d> hand_point;          ///< stated, in hand_frame; empty: at the feature
  std::optional<Matrix3d> stated_hand_axes;    ///< in hand_frame; empty: hand_axes
  Frame hand_frame = Frame::Inertial;          ///< of both
  Matrix3d hand_axes = Matrix3d::Identity();   ///< in E: approach axis along -n, with the roll
  Vector3d approach_axis = Vector3d::UnitZ();  ///< in the hand frame, unit

  bool magnitude_is_given() const { return source == ImpulseSource::Given; }
  /// Whether the whole impulse follows from the relative velocity (a sticking contact, a latch),
  /// and not its magnitude along a direction alone.
  bool is_rigid_contact() const { return law != ContactLaw::Frictionless; }
  /// Whether the hand moves right before the contact.
  bool hand_moves() const { return matched != MatchedPart::None; }
  /// Whether the target answers the impulse as a rigid body instead of a point mass.
  bool is_rigid() const { return source == ImpulseSource::RigidBody; }
  /// Whether direction and closing speed follow from the motion of the target.
  bool follows_target() const { return motion.has_value(); }
  /// Whether the hand must be at the contact feature instead of at a stated point.
  bool hand_follows_target() const { return motion.has_value() && !hand_point; }
  /// @pre follows_target()
  TargetState target_state(double time) const {
    return time == first_state.time ? first_state : motion->state(time);
  }
};

/// @throws InputError for a rigid-body contact with a stated direction, or when the direction has
///   to follow from a contact feature and there is none
EncounterModel encounter_model(const CaptureProblem& problem);

/// The encounter as nominal: direction n, no errors.
Scenario nominal_scenario(const EncounterModel& model);

/// The target at one time.
template <class S>
struct TargetKinematics {
  Matrix3<S> R_NT;
  Vector3<S> position;  ///< of the centroid in N, m
  Vector3<S> velocity;  ///< of the centroid in N, m/s
  Vector3<S> omega;     ///< in T, rad/s
};

/// Target and base relative to each other at one time. Without a nominal motion only R_EB is set.
template <class S>
struct ContactKinematics {
  Matrix3<S> R_EB;
  Vector3<S> point = Vector3<S>::Zero();     ///< contact feature in N, m
  Vector3<S> velocity = Vector3<S>::Zero();  ///< of the target's centroid, in T, m/s
  Vector3<S> omega = Vector3<S>::Zero();     ///< of the target, in T, rad/s

  /// Velocity of a point of the target, in T, m/s. @param r from its centroid, in T, m
  Vector3<S> velocity_at(const Vector3<S>& r) const { return velocity + omega.cross(r); }
};

/// Derivatives of ContactKinematics with respect to the contact time, base attitude fixed in N.
template <class S>
struct ContactRates {
  Vector3<S> omega_EB = Vector3<S>::Zero();  ///< angular velocity of B relative to E, in B, rad/s
  Vector3<S> point = Vector3<S>::Zero();     ///< of the contact feature in N, m/s
  Vector3<S> omega = Vector3<S>::Zero();     ///< of the target's rate in T, rad/s^2
};

/// The encounter along one direction, nominal or of a scenario.
template <class S>
struct Encounter {
  ContactKinematics<S> contact;
  Vector6<S> F;                    ///< wrench per unit of impulse at the hand, in B: [n; moment]
  S closing_speed = S(0);          ///< v_n = n . (v_target - v_hand), m/s
  double target_inverse_mass = 0;  ///< n' W_t n, 1/kg; 0 where the magnitude is given
};

/// State of the target at a time.
/// @pre model.follows_target()
template <class S>
TargetKinematics<S> target_kinematics(const EncounterModel& model, const S& time);

/// @pre model.follows_target()
template <class S>
ContactKinematics<S> contact_kinematics(const EncounterModel& model, const Matrix3<S>& R_NB,
                                        const TargetKinematics<S>& target);
/// With a stated direction; @pre not model.follows_target()
template <class S>
ContactKinematics<S> contact_kinematics(const EncounterModel& model, const Matrix3<S>& R_NB);
/// With the nominal motion of the target, or a stated direction.
template <class S>
ContactKinematics<S> contact_kinematics(const EncounterModel& model, const Matrix3<S>& R_NB,
                                        const S& time);
/// @param target, contact at the same time
/// @pre model.follows_target()
template <class S>
ContactRates<S> contact_rates(const EncounterModel& model, const TargetKinematics<S>& target,
                              const ContactKinematics<S>& contact);

/// @param contact at the scenario's time
template <class S>
Encounter<S> encounter_along(const EncounterModel& model, const ContactKinematics<S>& contact,
                             const Scenario& scenario);
/// The target right before a sticking contact or a latch, in B. A point mass has no extent: its
/// velocity is that of the contact feature. An offset of the contact point moves the place on the
/// target that the hand's origin takes hold of.
/// @param contact at the scenario's time
template <class S>
TargetAtHand<S> target_at_hand(const EncounterModel& model, const ContactKinematics<S>& contact,
                               const Scenario& scenario);
/// d/d(contact time) of its velocities, the base attitude relative to E fixed.
template <class S>
struct TargetAtHandRates {
  Vector3<S> velocity = Vector3<S>::Zero();  ///< m/s^2, in B
  Vector3<S> omega = Vector3<S>::Zero();     ///< rad/s^2, in B
};
template <class S>
TargetAtHandRates<S> target_at_hand_rates(const EncounterModel& model,
                                          const ContactKinematics<S>& contact,
                                          const ContactRates<S>& rates, const Scenario& scenario);

/// d closing_speed / d contact time, m/s^2.
template <class S>
S closing_speed_rate(const EncounterModel& model, const ContactKinematics<S>& contact,
                     const ContactRates<S>& rates, const Scenario& scenario);

/// Law, target and motion of the hand of a sticking contact or a latch. What the hand does is
/// decided for the nominal target: @pre of a hand that moves its velocity_error alone is not zero.
template <class S>
void set_rigid_contact(const EncounterModel& model, const ContactKinematics<S>& contact,
                       const Scenario& scenario, RigidContact<S>& out);

/// Axes in B that a hand with HandConstraint::Pose must have, one per column.
template <class S>
Matrix3<S> wanted_hand_axes(const EncounterModel& model, const Matrix3<S>& R_NB,
                            const Matrix3<S>& R_EB);

/// The start posture at the stated base pose and the earliest contact time.
Configuration start_configuration(const CaptureProblem& problem);

/// The nominal encounter at a configuration (its base attitude and contact time).
Encounter<double> encounter_at(const EncounterModel& model, const Configuration& configuration);

/// Where the target lies when its contact point is at the hand: constant in E.
struct TargetPlacement {
  Matrix3d R_ET = Matrix3d::Identity();  ///< axes of the target
  Vector3d r = Vector3d::Zero();         ///< from its centroid to the hand, in T, m
};
/// @pre the problem has a target body; a direction stated in B needs the stated base attitude
TargetPlacement target_placement(const CaptureProblem& problem, const EncounterModel& model);

/// W += W_t, the velocity of the target's contact point per impulse there, in B, 1/kg:
/// E/m + skew(r)' I^-1 skew(r), of a point mass E/m, and zero where the magnitude is given.
void add_target_inverse_inertia(const EncounterModel& model,
                                const ContactKinematics<double>& contact, Matrix3d& W);

/// Impulse along the encounter's direction by the contact law, N s.
/// @param hand_inverse_mass n' W_h n, 1/kg
double impulse_magnitude(const EncounterModel& model, const Encounter<double>& encounter,
                         double hand_inverse_mass);

/// The nominal impact at a configuration: the impulse by the problem's contact law, and all that
/// follows from it. No impulse where the bodies separate, or a sticking contact would pull. No
/// nonlinear program is built.
/// @throws InputError as encounter_model()
ImpactSummary impact_at(const CaptureProblem& problem, const Configuration& configuration);
/// The same at a known encounter. @param model of the problem; phi n
ImpactSummary impact_at(const CaptureProblem& problem, const EncounterModel& model,
                        const Encounter<double>& encounter, const JointVectord& phi);

}  // namespace stillbase
