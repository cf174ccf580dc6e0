// Impact whose impulse follows whole from the relative velocity: a sticking contact or a latch.
//
// With V = [v; omega] the velocity of the target's material point at the hand's origin, less that
// of the hand where it moves (hand_motion.hpp), and A = W_h + W_t, the impulse on the hand is F =
// A^-1 V; of a sticking contact this holds for the three linear components, and the moment is zero.
// F takes the role of "magnitude p times direction n" of the frictionless law: the response to it
// is the impact.
//
// The derivative takes one sweep more than none: with mu = A^-1 d psi / dF,
//   d psi = mu' (dV - dW_h F - dW_t F),  mu' W_h F = (J' mu)' H^-1 (J' F),
// the bilinear form of gradient.hpp with d = H^-1 J' F and H^-1 J' mu.
//
// After a latch the target belongs to the robot. Base part, coupling part and total are those of
// robot + target, about their common centroid, with c_t the target's centroid, s = c_t - g and
// m_r = M m_t / (M + m_t):
//   base  = (Htilde_omega + I_t + m_r skew(s)' skew(s)) Delta omega,
//   total = I_t omega_t + m_r s x v_t  (the target's momentum before the contact).
//
// Assumptions: the robot has no momentum before the impact; the hand is not fixed to the base. All
// in the axes of B.
#pragma once

#include <stillbase/impact/contact.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/impact/hand_motion.hpp>

namespace stillbase {

/// The target right before the contact.
template <class S>
struct TargetAtHand {
  S inverse_mass;              ///< 1/kg, > 0
  Matrix3<S> inertia;          ///< about the centroid, kg m^2; not used by a sticking contact
  Matrix3<S> inverse_inertia;  ///< zero: a point mass, which does not rotate
  Vector3<S> r;                ///< from the centroid to the hand's origin, m
  Vector3<S> velocity;         ///< of the centroid, m/s
  Vector3<S> omega;            ///< rad/s

  /// [v; omega] of the material point at the hand's origin.
  Vector6<S> velocity_at_hand() const {
    Vector6<S> V;
    V.template head<3>() = velocity + omega.cross(r);
    V.template tail<3>() = omega;
    return V;
  }
};

/// Such a contact at one posture.
template <class S>
struct RigidContact {
  ContactLaw law = ContactLaw::Latch;  ///< not Frictionless
  TargetAtHand<S> target;
  /// Which part of the hand's velocity is decided, and how; None: it is at rest.
  MatchedPart matched = MatchedPart::None;
  ArrivalRates rates = ArrivalRates::LeastJointRate;
  Vector3<S> n;  ///< where the part is Normal: unit
  /// The target's velocity at the hand less that of the hand, as decided. What the target is off
  /// by beside what the hand follows is a part of it.
  Vector6<S> apart;
  HandMotion<S> before;  ///< of the robot, where the hand moves
  Matrix6<S> A_factor;   ///< of W_h + W_t, factorize_cholesky(); sticking: of its linear part
  /// L^-1 of what unit forces and moments at the hand put on rotation and joints, L that of
  /// InertiaFactor (3 + n rows); sticking: of the forces alone.
  Eigen::Matrix<S, Eigen::Dynamic, 6, Eigen::RowMajor, kMaxJointsOf<S> + 3, 6> Z;
};

/// Impulse and response of the contact; the response's momenta are those of the robot, after a
/// latch those of robot + target. Where the hand moves, the response's velocities and momenta are
/// those right after the contact, contact.before those before it.
/// @param contact law, target and the hand's motion set; the others are filled
template <class S>
ImpactResponse<S> respond_to_contact(const PostureImpact<S>& posture, RigidContact<S>& contact);

/// Derivatives of psi, as in ResponseWeights, over all that decides the impact.
template <class S>
struct ContactGradient {
  JointVector<S> phi;  ///< over the joints, the target fixed in B (n)
  /// Over a small rotation of B (rad, in B), the target and what the hand is to do fixed in N.
  Vector3<S> turn;
  Vector3<S> velocity;  ///< over the velocity of the target's centroid
  Vector3<S> omega;     ///< over the target's angular velocity
  Vector6<S> apart;     ///< over RigidContact::apart; zero where the hand is at rest
};

/// @param contact, response of respond_to_contact()
/// @param weights its hand_inverse_mass is not used
template <class S>
ContactGradient<S> contact_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                    const RigidContact<S>& contact,
                                    const ImpactResponse<S>& response,
                                    const ResponseWeights<S>& weights);

/// The same of a function of the motion before the contact alone. @pre the hand moves
template <class S>
ContactGradient<S> motion_before_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                          const RigidContact<S>& contact,
                                          const HandMotionWeights<S>& weights);

}  // namespace stillbase
