// Reaction null spaces of equations (7) and (9), always with the rank found and the tolerance used.
//
// Planar robots have an angular coupling matrix of rank 1, some 3-D robots one of rank 2 in every
// posture: the rank is a result, never assumed.
#pragma once

#include <stillbase/dynamics/inertia.hpp>

namespace stillbase {

/// Singular values at or below `kRankTolerance * largest` count as zero.
inline constexpr double kRankTolerance = 1e-10;

/// Null space and pseudoinverse of a coupling matrix A (m x n, m <= 6).
struct ReactionNullSpace {
  int rank = 0;
  double rank_tolerance = kRankTolerance;  ///< relative to the largest singular value
  JointVectord singular_values;            ///< min(m, n), descending
  JointMatrixd P_RNS;                      ///< n x n projector E - A^+ A onto the null space of A
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, 6>
      A_pinv;  ///< n x m
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>
      range;  ///< m x rank, orthonormal basis of the range of A
};

/// Of any coupling matrix, by singular value decomposition.
ReactionNullSpace compute_reaction_null_space(const Matrix6Xd& A,
                                              double rank_tolerance = kRankTolerance);
ReactionNullSpace compute_reaction_null_space(const Matrix3Xd& A,
                                              double rank_tolerance = kRankTolerance);

/// Angular: of Htilde_omegaphi (9).
ReactionNullSpace angular_reaction_null_space(const TildeInertia<double>& tilde,
                                              double rank_tolerance = kRankTolerance);
/// Full: of H_bphi (7).
ReactionNullSpace full_reaction_null_space(const InertiaMatrices<double>& inertia,
                                           double rank_tolerance = kRankTolerance);
/// Translational: of H_vphi - H_vomega H_omega^-1 H_omegaphi (base rotation eliminated; the null
/// space of H_vphi alone does not keep the base centroid still).
ReactionNullSpace translational_reaction_null_space(const InertiaMatrices<double>& inertia,
                                                    double rank_tolerance = kRankTolerance);

/// phidot = rns + orthogonal, Proposition 1: the first part carries no momentum.
struct JointVelocityParts {
  JointVectord rns;         ///< P_RNS phidot
  JointVectord orthogonal;  ///< phidot - rns
};
JointVelocityParts decompose_joint_velocity(const ReactionNullSpace& space,
                                            const JointVectord& phidot);

}  // namespace stillbase
