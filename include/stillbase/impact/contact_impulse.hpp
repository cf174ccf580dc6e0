// One contact between the hand and the target: the impulse that a contact law asks for, and the
// velocities of robot and target after it. Both may move before.
//
// Assumptions: rigid bodies; the contact point is the origin of the hand frame; positions do not
// change while the impulse acts. Everything in the axes of B; velocities are those relative to the
// inertial frame N, in B components.
#pragma once

#include <string>

#include <stillbase/impact/contact.hpp>
#include <stillbase/impact/jump.hpp>

namespace stillbase {

/// Newton's restitution without slip would create energy in some contacts (Kane's paradox), so
/// restitution belongs to the frictionless law alone.
struct Contact {
  ContactLaw law = ContactLaw::Frictionless;
  double restitution = 0;          ///< e in [0, 1]; Frictionless only
  Vector3d n = Vector3d::UnitX();  ///< unit; direction of the impulse on the hand = outward
                                   ///< normal of the target
  /// Latch: the hand moves with the target and its grasp closes, whether the points close in or
  /// not.
  bool is_grasped = false;
};

/// The target at the instant of contact.
struct ContactTarget {
  double mass = 0;                       ///< kg, > 0
  Matrix3d inertia = Matrix3d::Zero();   ///< about the centroid, kg m^2; zero: a point mass, which
                                         ///< has no extent (r counts as zero) and does not rotate
  Vector3d r = Vector3d::Zero();         ///< contact point from the centroid, m
  Vector3d velocity = Vector3d::Zero();  ///< of the centroid, m/s
  Vector3d angular_velocity = Vector3d::Zero();  ///< rad/s

  bool is_point_mass() const { return inertia.isZero(0); }
  /// Velocity [v; omega] of the material point at the contact.
  Vector6d contact_velocity() const;
};

/// W_t3 = E/m_t - skew(r) I_t^-1 skew(r): velocity of the contact point per impulse there, 1/kg.
/// A point mass: E/m_t. n' W_t3 n is target_inverse_mass() of target.hpp.
Matrix3d target_inverse_inertia3(const ContactTarget& target);

/// W_t6: velocity [v; omega] at the contact per impulse [f; t] there,
///   [W_t3, -skew(r) I_t^-1; I_t^-1 skew(r), I_t^-1].
/// @throws std::invalid_argument for a point mass: it offers nothing to hold a moment against
Matrix6d target_inverse_inertia6(const ContactTarget& target);

enum class ContactStatus {
  Hit,         ///< the impulse is the law's
  Separating,  ///< the contact points do not close in: no impulse
  Pulling      ///< Sticking: holding the points together would take a pull, f . n < 0, which a
               ///< contact cannot give. No impulse is returned; the law does not apply here
};
std::string to_string(ContactStatus status);

struct ContactImpulse {
  ContactStatus status = ContactStatus::Separating;
  Vector6d Fbar = Vector6d::Zero();  ///< on the hand at its origin, [f; t], N s, N m s
  double closing_speed = 0;          ///< n . (v_target - v_hand) before, m/s
};

/// The impulse of a contact law:
///   Frictionless: p = (1+e) v_n / (n' W_h3 n + n' W_t3 n) along n,
///   Sticking:     f = (W_h3 + W_t3)^-1 v_rel, no moment,
///   Latch:        Fbar = (W_h6 + W_t6)^-1 V_rel.
/// Frictionless and sticking contacts need a closing speed > 0. A latch also holds at closing speed
/// zero (the target may still rotate or slide); where the points separate there is no impulse,
/// unless the contact is grasped.
/// @param W_h extended_inverse_inertia() with the joint resistance of the impact, 6x6
/// @param hand_velocity [v_h; omega_h] before
/// @throws std::invalid_argument for a latch onto a point mass
ContactImpulse contact_impulse(const Contact& contact, const Matrix6d& W_h,
                               const Vector6d& hand_velocity, const ContactTarget& target);

/// Velocities of robot and target at one instant.
struct ContactVelocities {
  Vector6d Omega = Vector6d::Zero();                    ///< of the base, [v; omega]
  JointVectord phidot;                                  ///< n
  Vector3d target_velocity = Vector3d::Zero();          ///< of the target's centroid, m/s
  Vector3d target_angular_velocity = Vector3d::Zero();  ///< rad/s
};

struct ContactOutcome {
  ContactImpulse impulse;
  ContactVelocities after;      ///< as before when there is no impulse
  double separation_speed = 0;  ///< n . (v_hand - v_target) after, m/s; >= 0 after an impact
};

/// Applies a contact law to robot and target. Momentum of the pair, linear and angular about any
/// fixed point, is conserved. Their kinetic energy never grows with free joints or rotor inertia
/// (rotors counted in). A servo or a lock only guarantees that for joints at rest before the
/// impact: the drive that keeps a moving joint at its rate does work.
/// @param phi joint positions (n); Omega, phidot velocity before
/// @throws std::invalid_argument for a latch onto a point mass
ContactOutcome apply_contact(const RobotModel& robot, const JointVectord& phi,
                             const Vector6d& Omega, const JointVectord& phidot,
                             const JointResistance& resistance, const Contact& contact,
                             const ContactTarget& target);

}  // namespace stillbase
