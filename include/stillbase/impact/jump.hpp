// The impact as a finite change of velocity, equations (6), (11) to (16).
//
// The impulse Fbar = [f; t] acts at the hand, in B components. Forces other than the impulse, and
// velocity-dependent ones, do nothing in the vanishing time of the impact.
#pragma once

#include <bitset>
#include <vector>

#include <stillbase/dynamics/inertia.hpp>
#include <stillbase/impact/joint_resistance.hpp>

namespace stillbase {

/// Delta Omega and Delta phidot of (6).
template <class S>
struct ImpactJump {
  Vector6<S> Delta_Omega;       ///< [Delta v; Delta omega] in B, m/s, rad/s
  JointVector<S> Delta_phidot;  ///< n, rad/s
};

/// Cholesky factor of the inertia matrix with base translation eliminated,
///   A = [Htilde_omega, Htilde_omegaphi; Htilde_omegaphi', Htilde_phi + D],
/// D the added impact inertia; rows and columns of locked joints are those of the identity. One
/// factor serves every impulse at a posture.
template <class S>
struct ImpactFactor {
  static constexpr int kMax = kMaxJointsOf<S> + 3;
  /// Unit lower triangle L of A = L D L'; the diagonal holds 1/D.
  Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMax, kMax> L;
  S mass;
  Vector3<S> r_bg;                 ///< system centroid in B, m
  Matrix3X<S> H_vphi;              ///< linear part of the coupling matrix
  std::bitset<kMaxJoints> locked;  ///< joints that do not move during the impact
};

/// @param added_inertia n; from added_impact_inertia()
/// @param locked n flags; empty: none
template <class S>
ImpactFactor<S> factorize_impact(const InertiaMatrices<S>& inertia,
                                 const JointVectord& added_inertia,
                                 const std::vector<bool>& locked);

/// Solves H [Delta Omega; Delta phidot] = [F_b; tau] for generalised impulses: F_b at the base
/// centroid (6), tau at the joints (n). With F_b = R_bh' Fbar and tau = J_phi' Fbar this is (6).
template <class S>
ImpactJump<S> solve_impact(const ImpactFactor<S>& factor, const Vector6<S>& F_b,
                           const JointVector<S>& tau);

/// (6) for an impulse at the hand.
template <class S>
ImpactJump<S> compute_jump(const ImpactFactor<S>& factor, const HandJacobian<S>& jacobian,
                           const Vector6<S>& Fbar);

/// (6) from joint positions on: by the inertia matrix, or for robots with kArticulatedBodyJoints
/// joints or more by articulated bodies, in O(n).
/// @param phi n; finite
/// @param added_inertia, locked as for factorize_impact()
template <class S>
ImpactJump<S> compute_jump(const RobotModel& robot, const JointVector<S>& phi,
                           const JointVectord& added_inertia, const std::vector<bool>& locked,
                           const Vector6<S>& Fbar);

/// Extended-inverse inertia tensor (Yoshida): W_h = J H^-1 J', J = [R_bh, J_phi], 6x6: hand
/// velocity change per impulse at the hand, base free.
Matrix6d extended_inverse_inertia(const ImpactFactor<double>& factor,
                                  const HandJacobian<double>& jacobian);

/// B of (14), (15): Delta omega = B Fbar, 3x6.
Eigen::Matrix<double, 3, 6> base_reaction_matrix(const ImpactFactor<double>& factor,
                                                 const HandJacobian<double>& jacobian);

/// Change of the angular momentum about the system centroid (16): R_ghomega' Fbar = r_gh x f + t.
template <class S>
Vector3<S> momentum_change(const InertiaMatrices<S>& inertia, const HandJacobian<S>& jacobian,
                           const Vector6<S>& Fbar);

}  // namespace stillbase
