// Articulated bodies: H x = b solved without the matrix H, in O(n).
//
// Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 7, with two changes. Twists and
// momenta of all bodies are taken about the base centroid in B, so inertias only add and nothing is
// transformed from link to link. What depends on the posture alone is kept as a factor, which then
// serves any number of right-hand sides.
//
// From about 14 joints on this is faster than the inertia matrix and its Cholesky factor, see
// kArticulatedBodyJoints. Up to 20 bodies the matrix in wide registers is faster, where a processor
// has them.
#pragma once

#include <stillbase/dynamics/bias.hpp>
#include <stillbase/dynamics/inertia_factor.hpp>

namespace stillbase {

/// Robots with at least this many joints are better served by articulated bodies: measured
/// crossover of a jump from joint positions on, see bench/README.md.
inline constexpr int kArticulatedBodyJoints = 14;

/// The factor of H + diag(0, added inertia); locked joints do not move.
template <class S>
struct ArticulatedBodies {
  BodyWorkspace<Vector6<S>, S> axis;  ///< twist [v; omega] of unit rate of joint k
  BodyWorkspace<Vector6<S>, S> U;     ///< momentum of the articulated body k under that twist
  BodyWorkspace<S, S> inverse_D;      ///< 1 / (axis' U + added inertia); 0 for a locked joint
  BodyWorkspace<Matrix3<S>, S> I;     ///< inertia of body k about its own centroid, in B axes
  Matrix6<S> L;                       ///< factor of the articulated inertia of the base
};

/// @param added_inertia added to the diagonal of H_phi (n), kg m^2 or kg
/// @param locked n flags; empty: none
template <class S>
ArticulatedBodies<S> factorize_articulated_bodies(const RobotModel& robot,
                                                  const Kinematics<S>& kinematics,
                                                  const JointVectord& added_inertia,
                                                  const std::vector<bool>& locked);

/// x = (H + diag(0, added inertia))^-1 [F_b; tau].
/// @param F_b at the base centroid, [force; moment] in B
/// @param tau at the joints (n); those of locked joints are not read
template <class S>
GeneralizedMotion<S> solve_articulated_bodies(const RobotModel& robot,
                                              const ArticulatedBodies<S>& bodies,
                                              const Vector6<S>& F_b, const JointVector<S>& tau);

/// (3) solved for the accelerations: H [dot Omega; phi''] = [F_b; tau] - [c_b; c_phi], Omega in
/// components of B.
template <class S>
GeneralizedMotion<S> articulated_acceleration(const RobotModel& robot,
                                              const Kinematics<S>& kinematics,
                                              const ArticulatedBodies<S>& bodies,
                                              const Vector6<S>& Omega, const JointVector<S>& phidot,
                                              const Vector6<S>& F_b, const JointVector<S>& tau);

}  // namespace stillbase
