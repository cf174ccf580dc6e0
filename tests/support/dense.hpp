// Dense matrices by Eigen's slow and sure ways, compiled once for all tests.
#pragma once

#include <Eigen/Core>

namespace stillbase::test {

/// X of A X = B, A square: LU with full pivoting.
Eigen::MatrixXd solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// x of least norm among those of least |A x - b|, by a complete orthogonal decomposition.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

double determinant(const Eigen::MatrixXd& A);

/// Descending, by Jacobi's rotations.
Eigen::VectorXd jacobi_singular_values(const Eigen::MatrixXd& A);

/// Ascending; A symmetric.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A);

}  // namespace stillbase::test
