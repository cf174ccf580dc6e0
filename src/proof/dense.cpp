#include "proof/dense.hpp"

#include <Eigen/Cholesky>

namespace stillbase::proof {

Eigen::MatrixXd inverse_cholesky_factor(const Eigen::MatrixXd& M) {
  if (!M.allFinite()) return {};
  const Eigen::LLT<Eigen::MatrixXd> llt(M);
  if (llt.info() != Eigen::Success) return {};
  const Eigen::MatrixXd inverse =
      llt.matrixL().solve(Eigen::MatrixXd::Identity(M.rows(), M.cols()));
  if (!inverse.allFinite()) return {};
  return inverse.triangularView<Eigen::Lower>();
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& M, const Eigen::VectorXd& b) {
  return M.ldlt().solve(b);
}

}  // namespace stillbase::proof
