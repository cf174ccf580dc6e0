#include "support/dense.hpp"

#include <Eigen/Dense>

namespace stillbase::test {

Eigen::MatrixXd solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return A.fullPivLu().solve(B);
}

Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.completeOrthogonalDecomposition().solve(b);
}

double determinant(const Eigen::MatrixXd& A) { return A.determinant(); }

Eigen::VectorXd jacobi_singular_values(const Eigen::MatrixXd& A) {
  return A.jacobiSvd().singularValues();
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace stillbase::test
