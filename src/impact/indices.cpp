#include <stillbase/impact/indices.hpp>

#include <algorithm>

#include <Eigen/Cholesky>
#include <stillbase/core/linear_algebra.hpp>

namespace stillbase {

namespace {

Vector6d force(const Vector3d& f) {
  Vector6d F = Vector6d::Zero();
  F.head<3>() = f;
  return F;
}

/// Null space of map on the allowed directions (map may stack several).
ZeroDirections zero_directions(const Eigen::MatrixXd& map, const Directions& allowed,
                               double threshold) {
  const Svd svd = right_svd(map * allowed);
  ZeroDirections out;
  out.singular_values = svd.sigma;
  while (out.rank < out.singular_values.size() && out.singular_values[out.rank] > threshold) {
    ++out.rank;
  }
  out.directions = allowed * svd.V.rightCols(allowed.cols() - out.rank);
  return out;
}

Matrix3d base_reaction_to_force(const PostureImpact<double>& posture) {
  return base_reaction_matrix(posture.factor, posture.jacobian).leftCols<3>();
}

}  // namespace

Directions all_directions() { return Matrix3d::Identity(); }

Directions directions_in_xy_plane() { return Matrix3d::Identity().leftCols<2>(); }

double effective_mass(const Matrix6d& W_h, const Vector3d& n) {
  return 1 / n.dot(W_h.topLeftCorner<3, 3>() * n);
}

double impulse_index(const Matrix6d& W_h, const Vector3d& n, double restitution,
                     double target_inverse_mass) {
  return (1 + restitution) / (n.dot(W_h.topLeftCorner<3, 3>() * n) + target_inverse_mass);
}

Ellipsoid impulse_ellipsoid(const Matrix6d& W_h, const Matrix3d& W_t3) {
  const Matrix3d W = W_h.topLeftCorner<3, 3>() + W_t3;
  const SymmetricEigen3 eigen = symmetric_eigen3(W);
  // Ascending eigenvalues of W are descending ones of its inverse.
  return {eigen.vectors, eigen.values.cwiseInverse()};
}

BaseReactionEllipsoid base_reaction_ellipsoid(const PostureImpact<double>& posture,
                                              double rank_tolerance) {
  const Svd3 svd = svd3(base_reaction_to_force(posture));
  BaseReactionEllipsoid out;
  out.ellipsoid = {svd.U, svd.sigma};
  out.causes = svd.V;
  out.rank_tolerance = rank_tolerance;
  out.rank = numerical_rank(svd.sigma, rank_tolerance);
  return out;
}

FavourableDirections favourable_directions(const PostureImpact<double>& posture,
                                           const Directions& allowed) {
  // The right singular vectors of B_f E are the eigenvectors of E' B_f' B_f E, without squaring.
  const Svd svd = right_svd(base_reaction_to_force(posture) * allowed);
  FavourableDirections out;
  out.directions = allowed * svd.V.rowwise().reverse();
  out.base_reaction = svd.sigma.reverse();
  return out;
}

MomentumMaps momentum_maps(const PostureImpact<double>& posture) {
  MomentumMaps maps;
  const Vector3d r_gh = posture.kinematics.r_bh - posture.inertia.r_bg;
  maps.arm = r_gh.norm();
  maps.total = skew(r_gh);
  for (int i = 0; i < 3; ++i) {
    const auto d = compute_jump(posture.factor, posture.jacobian, force(Vector3d::Unit(i)));
    maps.base.col(i) = posture.tilde.Htilde_omega * d.Delta_Omega.tail<3>();
    maps.coupling.col(i) = posture.tilde.Htilde_omegaphi * d.Delta_phidot;
  }
  return maps;
}

CaseDirections case_directions(const PostureImpact<double>& posture, const Directions& allowed,
                               double tolerance) {
  const MomentumMaps maps = momentum_maps(posture);
  const double threshold = tolerance * maps.arm;
  Eigen::MatrixXd stacked(6, 3);  // the total is their sum
  stacked << maps.base, maps.coupling;
  CaseDirections out;
  out.tolerance = tolerance;
  out.base = zero_directions(maps.base, allowed, threshold);
  out.coupling = zero_directions(maps.coupling, allowed, threshold);
  out.total = zero_directions(maps.total, allowed, threshold);
  out.all = zero_directions(stacked, allowed, threshold);
  return out;
}

GeneralizedJacobianIndices generalized_jacobian_indices(const PostureImpact<double>& posture) {
  const auto hat = compute_hat_inertia(posture.inertia, posture.jacobian);
  GeneralizedJacobianIndices out;
  out.all = singular_values(hat.Jhat_phi);
  out.linear = singular_values(hat.Jhat_phi.topRows<3>());
  out.angular = singular_values(hat.Jhat_phi.bottomRows<3>());
  if (out.linear.size() == 3) out.linear_manipulability = out.linear.prod();
  if (out.angular.size() == 3) out.angular_manipulability = out.angular.prod();
  return out;
}

DynamicCoupling dynamic_coupling(const PostureImpact<double>& posture, double rank_tolerance) {
  DynamicCoupling out;
  if (posture.jacobian.J_phi.cols() == 0) return out;
  const auto hat = compute_hat_inertia(posture.inertia, posture.jacobian);
  const Eigen::MatrixXd X = posture.inertia.H_b.llt().solve(posture.inertia.H_bphi);
  out.translation_per_rate = singular_values(X.topRows(3));
  out.rotation_per_rate = singular_values(X.bottomRows(3));
  const Matrix3Xd Jhat_v = hat.Jhat_phi.topRows<3>();
  const ReactionNullSpace space = compute_reaction_null_space(Jhat_v, rank_tolerance);
  out.hand_rank = space.rank;
  out.rotation_per_hand = singular_values(X.bottomRows(3) * space.A_pinv);
  return out;
}

}  // namespace stillbase
