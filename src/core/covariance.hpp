// What makes a matrix a covariance.
#pragma once

#include <cmath>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace stillbase {

/// Of the deviations, and of the least eigenvalue of the correlations.
inline constexpr double kCovarianceTolerance = 1e-9;

struct CovarianceObjection {
  int row;           ///< that it is about; 0 when it is about the whole matrix
  std::string text;  ///< to follow the name of the matrix: "[1][1]: is -1; a variance ..."
};

/// What keeps a finite square matrix from being a covariance: it has to be symmetric to 1e-9 of the
/// deviations and positive semidefinite to 1e-9 of its correlations, whatever the units of its
/// rows. Nothing: it is one.
std::optional<CovarianceObjection> covariance_objection(const Eigen::MatrixXd& A);

/// Whether A is finite and covariance_objection() has nothing against it. Allocates nothing.
template <int N>
bool is_covariance(const Eigen::Matrix<double, N, N>& A) {
  if (!A.allFinite() || !(A.diagonal().minCoeff() >= 0)) return false;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < i; ++j) {
      const double size = std::sqrt(A(i, i) * A(j, j));
      if (!(std::abs(A(i, j) - A(j, i)) <= kCovarianceTolerance * size)) return false;
      if (!(std::abs(A(i, j)) <= (1 + kCovarianceTolerance) * size)) return false;
    }
  }
  Eigen::Matrix<double, N, 1> scale;
  for (int i = 0; i < N; ++i) scale[i] = A(i, i) > 0 ? 1 / std::sqrt(A(i, i)) : 0;
  const Eigen::Matrix<double, N, N> correlations = scale.asDiagonal() * A * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver(correlations,
                                                                          Eigen::EigenvaluesOnly);
  return solver.eigenvalues().minCoeff() >= -kCovarianceTolerance;
}

}  // namespace stillbase
