// What a posture says about impacts in general: how heavy the hand is, where the base reacts least,
// in which directions the angular momenta of the paper's cases vanish.
//
// All in B, for impulses at the hand's origin. The joint resistance is the one the posture was
// evaluated with. Numbers [..] are those of the paper's reference list.
#pragma once

#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/impact/cases.hpp>
#include <stillbase/impact/gradient.hpp>

namespace stillbase {

/// m orthonormal directions as columns, 3 x m.
using Directions = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
/// At most three numbers.
using UpToThree = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;

/// Directions allowed to an impulse: all of space, or those in the xy plane of B (planar robots).
Directions all_directions();
Directions directions_in_xy_plane();

/// Effective mass of the hand along n, kg: 1 / (n' W_h3 n) (Khatib's, of the free-floating robot).
/// @param W_h extended-inverse inertia tensor, 6x6 (Yoshida [11]); n unit
double effective_mass(const Matrix6d& W_h, const Vector3d& n);

/// Impulse index (Yoshida and Sashida [10]): impulse per unit approach speed along n, kg:
///   (1 + e) / (n' W_h3 n + w_t).
/// @param target_inverse_mass w_t, 1/kg; 0: a target that cannot be moved, which makes the index
/// (1 + e) times the effective mass
double impulse_index(const Matrix6d& W_h, const Vector3d& n, double restitution,
                     double target_inverse_mass);

/// An ellipsoid by its principal axes.
struct Ellipsoid {
  Matrix3d axes = Matrix3d::Identity();  ///< columns, orthonormal
  Vector3d lengths = Vector3d::Zero();   ///< half axes, descending
};

/// Impulse ellipsoid ([10]; Walker's impact ellipsoids [5]): the impulses (W_h3 + W_t3)^-1 v that
/// stop relative velocities |v| = 1 m/s of the contact points. Lengths in N s per m/s = kg.
/// @param W_t3 target_inverse_inertia3(); zero: a target that cannot be moved
Ellipsoid impulse_ellipsoid(const Matrix6d& W_h, const Matrix3d& W_t3);

/// Base-reaction ellipsoid: the base rates B [f; 0] of impulses |f| = 1 N s, B of (15). Lengths in
/// rad/s per N s; axes are directions of the base rate.
struct BaseReactionEllipsoid {
  Ellipsoid ellipsoid;
  Matrix3d causes = Matrix3d::Identity();  ///< columns: the impulse direction behind each axis
  int rank = 0;                            ///< lengths above the tolerance; planar robots: 2
  double rank_tolerance = kRankTolerance;  ///< relative to the largest length
};
BaseReactionEllipsoid base_reaction_ellipsoid(const PostureImpact<double>& posture,
                                              double rank_tolerance = kRankTolerance);

/// Impulse directions ordered by how little the base reacts to a unit impulse: the eigenvectors of
/// E' B_f' B_f E, E the allowed directions. For an impulse that also changes its size with the
/// direction (a contact law) these are not the minima: this is per unit impulse.
struct FavourableDirections {
  Directions directions;    ///< 3 x m, orthonormal, in B; the first has the least reaction
  UpToThree base_reaction;  ///< |Delta omega| for 1 N s, ascending, rad/s per N s
};
FavourableDirections favourable_directions(const PostureImpact<double>& posture,
                                           const Directions& allowed);

/// Angular momenta per unit impulse: 3x3 maps from f to N m s, total = base + coupling.
struct MomentumMaps {
  Matrix3d total;     ///< skew(r_gh), (16)
  Matrix3d base;      ///< Htilde_omega B_f
  Matrix3d coupling;  ///< Htilde_omegaphi d(Delta phidot)/df
  double arm = 0;     ///< |r_gh|, m: the scale of a momentum per unit impulse, as in judge_case()
};
MomentumMaps momentum_maps(const PostureImpact<double>& posture);

/// Impulse directions without effect on one of the momenta.
struct ZeroDirections {
  Directions directions;      ///< 3 x (m - rank), orthonormal basis, in B; every mix is a zero too
  int rank = 0;               ///< of the map on the allowed directions
  UpToThree singular_values;  ///< m, descending; N m s per N s = m
};

/// The zero directions of the cases at a posture. A singular value counts as zero at or below
/// tolerance * |r_gh|, so that an impulse along a zero direction is judged zero by judge_case()
/// with the same tolerance.
struct CaseDirections {
  double tolerance = kCaseTolerance;
  ZeroDirections base;      ///< G2 (or C2): the base does not start to rotate
  ZeroDirections coupling;  ///< G3 (or C2)
  ZeroDirections total;     ///< C1 (or C2): r_gh itself, unless it is not allowed
  ZeroDirections all;       ///< C2
};
CaseDirections case_directions(const PostureImpact<double>& posture, const Directions& allowed,
                               double tolerance = kCaseTolerance);

/// Singular values of the generalized Jacobian Jhat_phi of (4) (Umetani and Yoshida, [26]).
struct GeneralizedJacobianIndices {
  JointVectord all;   ///< min(6, n), descending. Mixes m and rad: depends on the unit of length
  UpToThree linear;   ///< min(3, n) of the rows of v_h
  UpToThree angular;  ///< min(3, n) of the rows of omega_h
  /// Manipulability (Yoshikawa 1985) of each part: sqrt(det(J J')), the product of three singular
  /// values; 0 for n < 3.
  double linear_manipulability = 0, angular_manipulability = 0;
};
GeneralizedJacobianIndices generalized_jacobian_indices(const PostureImpact<double>& posture);

/// How much of the arm's motion goes into the base at zero momentum.
struct DynamicCoupling {
  /// Singular values of -H_b^-1 H_bphi, base velocity per joint rate, its rows of omega and of v
  /// apart (the singular-value measure of base-joint coupling of Zhou, Luo, Wang 2019). The largest
  /// is the worst case over joint rates |phidot| = 1.
  UpToThree rotation_per_rate;     ///< min(3, n); rad/s per rad/s
  UpToThree translation_per_rate;  ///< min(3, n); m/s per rad/s
  /// Singular values of the map from hand velocity to base rate, -(H_b^-1 H_bphi)_omega Jhat_v^+,
  /// with the least joint rates for that hand velocity. Relates hand and base as Xu (1993) does;
  /// that he takes this norm is not checked. rad/s per m/s; 3
  Vector3d rotation_per_hand = Vector3d::Zero();
  int hand_rank = 0;  ///< of Jhat_v; hand velocities outside its range count as not asked for
};
DynamicCoupling dynamic_coupling(const PostureImpact<double>& posture,
                                 double rank_tolerance = kRankTolerance);

}  // namespace stillbase
