// The impact as a finite change of velocity, equations (6), (11) to (16).
//
// The impulse Fbar = [f; t] acts at the hand, in B components. Forces other than the impulse, and
// velocity-dependent ones, do nothing in the vanishing time of the impact.
#pragma once

#include <vector>

#include <stillbase/dynamics/inertia_factor.hpp>
#include <stillbase/impact/joint_resistance.hpp>

namespace stillbase {

/// Delta Omega and Delta phidot of (6).
template <class S>
struct ImpactJump {
  Vector6<S> Delta_Omega;       ///< [Delta v; Delta omega] in B, m/s, rad/s
  JointVector<S> Delta_phidot;  ///< n, rad/s
};

/// (6) for an impulse at the hand: H [Delta Omega; Delta phidot] = [R_bh'; J_phi'] Fbar.
template <class S>
ImpactJump<S> compute_jump(const InertiaFactor<S>& factor, const HandJacobian<S>& jacobian,
                           const Vector6<S>& Fbar);

/// (6) from joint positions on: by the inertia matrix, or for robots with kArticulatedBodyJoints
/// joints or more by articulated bodies, in O(n). Of doubles in wide registers the matrix wins as
/// long as the robot fits into them, up to 20 bodies.
/// @param phi n; finite
/// @param added_inertia, locked as for factorize_inertia()
template <class S>
ImpactJump<S> compute_jump(const RobotModel& robot, const JointVector<S>& phi,
                           const JointVectord& added_inertia, const std::vector<bool>& locked,
                           const Vector6<S>& Fbar);
template <>
ImpactJump<double> compute_jump(const RobotModel& robot, const JointVectord& phi,
                                const JointVectord& added_inertia, const std::vector<bool>& locked,
                                const Vector6d& Fbar);

/// Extended-inverse inertia tensor (Yoshida): W_h = J H^-1 J', J = [R_bh, J_phi], 6x6: hand
/// velocity change per impulse at the hand, base free.
Matrix6d extended_inverse_inertia(const InertiaFactor<double>& factor,
                                  const HandJacobian<double>& jacobian);

/// B of (14), (15): Delta omega = B Fbar, 3x6.
Eigen::Matrix<double, 3, 6> base_reaction_matrix(const InertiaFactor<double>& factor,
                                                 const HandJacobian<double>& jacobian);

/// Change of the angular momentum about the system centroid (16): R_ghomega' Fbar = r_gh x f + t.
template <class S>
Vector3<S> momentum_change(const InertiaMatrices<S>& inertia, const HandJacobian<S>& jacobian,
                           const Vector6<S>& Fbar);

}  // namespace stillbase
