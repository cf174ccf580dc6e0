#include <catch2/catch.hpp>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/random.hpp>

using namespace stillbase;

namespace {

constexpr double kRounding = 1e-13;

Eigen::MatrixXd random_matrix(Random& random, int rows, int columns) {
  Eigen::MatrixXd A(rows, columns);
  for (double& a : A.reshaped()) a = random.uniform(-1, 1);
  return A;
}

/// 4 x 5 of rank 2.
Eigen::MatrixXd rank_two() {
  Random random(1);
  return random_matrix(random, 4, 2) * random_matrix(random, 2, 5);
}

bool is_orthonormal(const Eigen::MatrixXd& Q) {
  return (Q.transpose() * Q - Eigen::MatrixXd::Identity(Q.cols(), Q.cols())).norm() < kRounding;
}

}  // namespace

TEST_CASE("singular vectors rebuild a matrix, and the last right ones span its null space") {
  const Eigen::MatrixXd A = rank_two();
  const Svd thin = thin_svd(A), right = right_svd(A);
  CHECK((thin.U * thin.sigma.asDiagonal() * thin.V.transpose() - A).norm() < kRounding);
  CHECK(thin.sigma == singular_values(A));
  CHECK(right.sigma == thin.sigma);
  REQUIRE(numerical_rank(thin.sigma, 1e-10) == 2);
  CHECK(is_orthonormal(right.V));
  CHECK((A * right.V.rightCols(3)).norm() < kRounding);
  CHECK(singular_values(Eigen::MatrixXd(3, 0)).size() == 0);
  CHECK(numerical_rank(Eigen::VectorXd(), 1e-10) == 0);
  CHECK(numerical_rank(Eigen::VectorXd::Zero(3), 1e-10) == 0);
}

TEST_CASE("the eigenvectors of a symmetric matrix diagonalise it, values ascending") {
  Random random(2);
  const Eigen::MatrixXd B = random_matrix(random, 3, 3);
  const Matrix3d A = B + B.transpose();
  const SymmetricEigen3 small = symmetric_eigen3(A);
  const SymmetricEigen any = symmetric_eigen(A);
  CHECK(
      (small.vectors.transpose() * A * small.vectors - Matrix3d(small.values.asDiagonal())).norm() <
      kRounding);
  CHECK((any.values - small.values).norm() < kRounding);
  CHECK((principal_moments(A) - small.values).norm() < kRounding);
  CHECK((symmetric_eigenvalues(A) - small.values).norm() < kRounding);
  CHECK(small.values[0] <= small.values[1]);
  CHECK(small.values[1] <= small.values[2]);
  const Svd3 svd = svd3(A);
  CHECK((svd.U * svd.sigma.asDiagonal() * svd.V.transpose() - A).norm() < kRounding);
}

TEST_CASE("the least-norm solution of a singular system is that of the pseudo-inverse") {
  const Eigen::MatrixXd A = rank_two();
  Random random(3);
  const Eigen::VectorXd b = random_matrix(random, 4, 1);
  const Eigen::VectorXd x = least_norm_solution(A, b, 1e-9);
  CHECK((A.transpose() * (A * x - b)).norm() < kRounding);
  CHECK((right_svd(A).V.rightCols(3).transpose() * x).norm() < kRounding);
  CHECK((pseudo_inverse(A, 1e-9) * b - x).norm() < kRounding);
}

TEST_CASE("a pivoted QR splits the space into the columns' span and its complement") {
  const Eigen::MatrixXd A = rank_two();
  const PivotedQr qr(A);
  REQUIRE(qr.rank() == 2);
  const Eigen::MatrixXd N = qr.complement();
  REQUIRE(N.cols() == 2);
  CHECK(is_orthonormal(N));
  CHECK((A.transpose() * N).norm() < kRounding);
  Random random(4);
  const Eigen::MatrixXd B = random_matrix(random, 4, 3);
  CHECK((qr.complement_components(B) - N.transpose() * B).norm() < kRounding);
  const Eigen::VectorXd x = qr.solve(B.col(0));
  CHECK((A.transpose() * (A * x - B.col(0))).norm() < kRounding);
  CHECK((qr.solve_columns(B).col(0) - x).norm() < kRounding);
}
