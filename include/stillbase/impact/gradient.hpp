// The impact of one wrench at one posture, and exact derivatives of anything smooth in it.
//
// The derivative needs no derivative of a matrix: with d = H^-1 J' F and an adjoint lambda, all n
// partial derivatives of lambda' (J' F - H d) come from one sweep over the tree, O(n), at about the
// cost of the value itself.
#pragma once

#include <stillbase/impact/jump.hpp>

namespace stillbase {

/// What one posture says about every impulse: evaluated once, used for all directions.
template <class S>
struct PostureImpact {
  Kinematics<S> kinematics;
  InertiaMatrices<S> inertia;
  TildeInertia<S> tilde;
  HandJacobian<S> jacobian;
  InertiaFactor<S> factor;
};

/// Added inertia and locked joints of an impact, prepared once.
struct ImpactResistance {
  JointVectord added_inertia;  ///< n
  std::vector<bool> locked;    ///< n, or empty
};
ImpactResistance prepare_resistance(const JointResistance& resistance, int n);

/// @param phi joint positions (n); finite
template <class S>
PostureImpact<S> evaluate_posture(const RobotModel& robot, const ImpactResistance& resistance,
                                  const JointVector<S>& phi);

/// Kinematics and Jacobian alone, for what depends on the place of the bodies and of the hand; the
/// other members are not set and may not be read.
template <class S>
PostureImpact<S> evaluate_hand(const RobotModel& robot, const JointVector<S>& phi);

/// Response to the wrench F = [f; t] at the hand (in B).
template <class S>
struct ImpactResponse {
  Vector6<S> F;
  ImpactJump<S> d;      ///< H^-1 J' F
  Vector3<S> total;     ///< Delta L_g (16)
  Vector3<S> base;      ///< Htilde_omega Delta omega
  S hand_inverse_mass;  ///< F' W_h F: for a unit force the inverse effective mass, 1/kg
  /// What a target that a latch holds adds to H_b Delta Omega, N s, N m s; zero else.
  Vector6<S> held_momentum = Vector6<S>::Zero();
  Vector3<S> omega() const { return d.Delta_Omega.template tail<3>(); }
  Vector3<S> coupling() const { return total - base; }
};

template <class S>
ImpactResponse<S> respond(const PostureImpact<S>& posture, const Vector6<S>& F);

/// Weights of psi = u_velocity . Delta v + u_omega . Delta omega + u_base . base + u_total . total
///                + s F' W_h F + u_momentum . H_b Delta Omega + u_phidot . Delta phidot
///                + u_force . f.
template <class S>
struct ResponseWeights {
  Vector3<S> velocity = Vector3<S>::Zero();
  Vector3<S> omega = Vector3<S>::Zero();
  Vector3<S> base = Vector3<S>::Zero();
  Vector3<S> total = Vector3<S>::Zero();
  S hand_inverse_mass = S(0);
  Vector6<S> momentum = Vector6<S>::Zero();
  JointVector<S> phidot;  ///< n, or empty
  Vector3<S> force = Vector3<S>::Zero();
};

/// d psi / d phi with F fixed in B (n), and d psi / d F (6).
template <class S>
struct ResponseGradient {
  JointVector<S> phi;
  Vector6<S> F;
};

/// Exact gradient of psi by the adjoint sweep. Any smooth function of the response has its gradient
/// here: put its partial derivatives into the weights.
template <class S>
ResponseGradient<S> response_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                      const ImpactResponse<S>& response,
                                      const ResponseWeights<S>& weights);

/// d/dphi of y . Htilde_omegaphi e_i, y fixed in B (n): how column i of the angular coupling matrix
/// changes with the posture.
template <class S>
JointVector<S> coupling_column_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                        int i, const Vector3<S>& y);

/// d/dphi of y . Htilde_omegaphi w, w (n) and y fixed, in B (n).
template <class S>
JointVector<S> coupling_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                 const JointVector<S>& w, const Vector3<S>& y);

/// d/dphi of y . Jhat_phi w, w (n) and y = [linear; angular] fixed, in B (n): how the hand's motion
/// with the base floating changes with the posture.
template <class S>
JointVector<S> generalized_jacobian_gradient(const RobotModel& robot,
                                             const PostureImpact<S>& posture,
                                             const JointVector<S>& w, const Vector6<S>& y);

}  // namespace stillbase
