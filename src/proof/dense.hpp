// Decompositions of plain matrices of doubles, compiled once. What they return are good guesses:
// whatever is proven with them is true of any matrix.
#pragma once

#include <Eigen/Core>

namespace stillbase::proof {

/// L^-1 of the Cholesky factor M = L L', lower triangular; empty: M has none.
Eigen::MatrixXd inverse_cholesky_factor(const Eigen::MatrixXd& M);

/// M^-1 b of a symmetric matrix.
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& M, const Eigen::VectorXd& b);

}  // namespace stillbase::proof
