// Cholesky factor of the inertia matrix of (3), with base translation eliminated.
#pragma once

#include <bitset>
#include <vector>

#include <stillbase/dynamics/inertia.hpp>

namespace stillbase {

/// A velocity, a jump of it, or an acceleration of base and joints.
template <class S>
struct GeneralizedMotion {
  Vector6<S> Omega;       ///< base twist [v; omega] in B
  JointVector<S> phidot;  ///< n
};

/// Factor of H + diag(0, D), D an added inertia of the joints, from
///   A = [Htilde_omega, Htilde_omegaphi; Htilde_omegaphi', Htilde_phi + D].
/// Rows and columns of locked joints are those of the identity. One factor serves every right-hand
/// side at a posture.
template <class S>
struct InertiaFactor {
  /// Unit lower triangle L of A = L D L'; the diagonal holds 1/D.
  InPlaceMatrix<S, kJointsInPlace<S> + 3> L;
  S mass;
  Vector3<S> r_bg;                 ///< system centroid in B, m
  Matrix3X<S> H_vphi;              ///< linear part of the coupling matrix
  std::bitset<kMaxJoints> locked;  ///< joints that do not move
};

/// @param added_inertia D (n), kg m^2 or kg
/// @param locked n flags; empty: none
template <class S>
InertiaFactor<S> factorize_inertia(const InertiaMatrices<S>& inertia,
                                   const JointVectord& added_inertia,
                                   const std::vector<bool>& locked);

/// x of (H + diag(0, D)) x = [F_b; tau]; locked joints do not move.
/// @param F_b at the base centroid, [force; moment] in B
/// @param tau at the joints (n); those of locked joints are not read
template <class S>
GeneralizedMotion<S> solve_inertia(const InertiaFactor<S>& factor, const Vector6<S>& F_b,
                                   const JointVector<S>& tau);

}  // namespace stillbase
