// Joint accelerations for a wanted base acceleration: equations (7) and (9), and the same for the
// base centroid, with external forces on base and hand.
//
// All in B; accelerations are derivatives of B components, as in (3). A wanted acceleration outside
// the range of the coupling matrix cannot be had: the answer is then the one of least squares, and
// what is missing is reported.
#pragma once

#include <stillbase/dynamics/bias.hpp>
#include <stillbase/dynamics/reaction_null_space.hpp>

namespace stillbase {

/// The terms of (3) at one state that the base equations need.
struct BaseEquation {
  const InertiaMatrices<double>& inertia;
  const BiasForces<double>& bias;
  const HandJacobian<double>& jacobian;
};

/// External wrenches [f; t] in B: on the base at its centroid, on the hand at its origin.
struct ExternalWrenches {
  Vector6d F_b = Vector6d::Zero();
  Vector6d F_h = Vector6d::Zero();
};

struct JointAcceleration {
  JointVectord phiddot;     ///< n
  ReactionNullSpace space;  ///< of the coupling matrix; with rank and tolerance
  /// Force or moment that the joints would have to give and cannot: the part of the right-hand side
  /// outside the range of the coupling matrix. 6 (7) or 3 (others); N, N m. Zero: wanted = given.
  Eigen::VectorXd missing;
};

/// (7): phi'' = H_bphi^+ (F_b + R_bh' F_h - H_b dot Omega - c_b) + P_RNS xi.
/// @param dot_Omega wanted base acceleration [dot v; dot omega]
/// @param xi n; free choice, acts within the reaction null space only
JointAcceleration joint_acceleration_for_base(const BaseEquation& equation,
                                              const ExternalWrenches& external,
                                              const Vector6d& dot_Omega, const JointVectord& xi,
                                              double rank_tolerance = kRankTolerance);

/// (9): phi'' = Htilde_omegaphi^+ (ttilde_b + R_ghomega' F_h - Htilde_omega dot omega -
/// ctilde_omega) + P_RNSomega xi, with ttilde_b = t_b - r_bg x f_b the base wrench's moment about
/// the system centroid. The base's translation is left to itself.
JointAcceleration joint_acceleration_for_rotation(const BaseEquation& equation,
                                                  const ExternalWrenches& external,
                                                  const Vector3d& dot_omega, const JointVectord& xi,
                                                  double rank_tolerance = kRankTolerance);

/// The same with base rotation eliminated: the coupling matrix is H_vphi - H_vomega H_omega^-1
/// H_omegaphi. The base's rotation is left to itself.
/// @param dot_v wanted derivative of the B components of the base centroid's velocity; a centroid
/// that moves uniformly in N has dot v = -omega x v
JointAcceleration joint_acceleration_for_translation(const BaseEquation& equation,
                                                     const ExternalWrenches& external,
                                                     const Vector3d& dot_v, const JointVectord& xi,
                                                     double rank_tolerance = kRankTolerance);

/// Base acceleration that joint accelerations bring: the upper rows of (3), solved for dot Omega.
Vector6d base_acceleration(const BaseEquation& equation, const ExternalWrenches& external,
                           const JointVectord& phiddot);

/// Joint torques that go with it: the lower rows of (3), n.
JointVectord joint_torque(const BaseEquation& equation, const ExternalWrenches& external,
                          const Vector6d& dot_Omega, const JointVectord& phiddot);

}  // namespace stillbase
