#include <stillbase/dynamics/reaction_null_space.hpp>

#include <Eigen/Cholesky>
#include <stillbase/core/linear_algebra.hpp>

namespace stillbase {

namespace {

ReactionNullSpace from_dense(const Eigen::MatrixXd& A, double rank_tolerance) {
  const Eigen::Index m = A.rows(), n = A.cols();
  ReactionNullSpace out;
  out.rank_tolerance = rank_tolerance;
  if (n == 0) {  // a robot without joints; the decomposition does not take an empty matrix
    out.A_pinv.resize(0, m);
    out.range.resize(m, 0);
    return out;
  }
  const Svd svd = thin_svd(A);
  out.rank = numerical_rank(svd.sigma, rank_tolerance);
  out.singular_values = svd.sigma;
  const auto U = svd.U.leftCols(out.rank);
  const auto V = svd.V.leftCols(out.rank);
  out.P_RNS = JointMatrixd::Identity(n, n) - JointMatrixd(V * V.transpose());
  out.A_pinv = V * svd.sigma.head(out.rank).cwiseInverse().asDiagonal() * U.transpose();
  if (out.rank == 0) out.A_pinv.setZero(n, m);
  out.range = U;
  return out;
}

}  // namespace

ReactionNullSpace compute_reaction_null_space(const Matrix6Xd& A, double rank_tolerance) {
  return from_dense(A, rank_tolerance);
}

ReactionNullSpace compute_reaction_null_space(const Matrix3Xd& A, double rank_tolerance) {
  return from_dense(A, rank_tolerance);
}

ReactionNullSpace angular_reaction_null_space(const TildeInertia<double>& tilde,
                                              double rank_tolerance) {
  return from_dense(tilde.Htilde_omegaphi, rank_tolerance);
}

ReactionNullSpace full_reaction_null_space(const InertiaMatrices<double>& inertia,
                                           double rank_tolerance) {
  return from_dense(inertia.H_bphi, rank_tolerance);
}

ReactionNullSpace translational_reaction_null_space(const InertiaMatrices<double>& inertia,
                                                    double rank_tolerance) {
  const Matrix3d H_vomega = inertia.H_b.topRightCorner<3, 3>();
  const Matrix3d H_omega = inertia.H_b.bottomRightCorner<3, 3>();
  const Eigen::MatrixXd A =
      inertia.H_bphi.topRows<3>() - H_vomega * H_omega.llt().solve(inertia.H_bphi.bottomRows<3>());
  return from_dense(A, rank_tolerance);
}

JointVelocityParts decompose_joint_velocity(const ReactionNullSpace& space,
                                            const JointVectord& phidot) {
  const JointVectord rns = space.P_RNS * phidot;
  return {rns, phidot - rns};
}

}  // namespace stillbase
