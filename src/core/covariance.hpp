// What makes a matrix a covariance.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

namespace stillbase {

struct CovarianceObjection {
  int row;           ///< that it is about; 0 when it is about the whole matrix
  std::string text;  ///< to follow the name of the matrix: "[1][1]: is -1; a variance ..."
};

/// What keeps a finite square matrix from being a covariance: it has to be symmetric to 1e-9 of the
/// deviations and positive semidefinite to 1e-9 of its correlations, whatever the units of its
/// rows. Nothing: it is one.
std::optional<CovarianceObjection> covariance_objection(const Eigen::MatrixXd& A);

}  // namespace stillbase
