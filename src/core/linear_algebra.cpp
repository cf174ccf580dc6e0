#include <stillbase/core/linear_algebra.hpp>

#include <algorithm>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace stillbase {

Eigen::VectorXd singular_values(const Eigen::MatrixXd& A) {
  if (A.size() == 0) return {};
  return Eigen::JacobiSVD<Eigen::MatrixXd>(A).singularValues();
}

Svd thin_svd(const Eigen::MatrixXd& A) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

Svd right_svd(const Eigen::MatrixXd& A) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  return {{}, svd.singularValues(), svd.matrixV()};
}

Svd3 svd3(const Matrix3d& A) {
  const Eigen::JacobiSVD<Matrix3d> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

int numerical_rank(const Eigen::Ref<const Eigen::VectorXd>& sigma, double relative_tolerance) {
  int rank = 0;
  while (rank < sigma.size() && sigma[rank] > relative_tolerance * sigma[0]) ++rank;
  return rank;
}

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

SymmetricEigen3 symmetric_eigen3(const Matrix3d& A) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(A);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

Vector3d principal_moments(const Matrix3d& inertia) {
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                    double threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(threshold);
  return solver.compute(A).solve(b);
}

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& A, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(threshold);
  return solver.compute(A).pseudoInverse();
}

PivotedQr::Qr PivotedQr::decompose(const Eigen::MatrixXd& A) {
  if (std::max(A.rows(), A.cols()) <= kInPlace) {
    return Qr(std::in_place_index<0>, InPlace(A));
  }
  return Qr(std::in_place_index<1>, A);
}

PivotedQr::PivotedQr(const Eigen::MatrixXd& A, std::optional<double> threshold)
    : qr_(decompose(A)) {
  if (threshold) std::visit([&](auto& qr) { qr.setThreshold(*threshold); }, qr_);
}

Eigen::Index PivotedQr::rank() const {
  return std::visit([](const auto& qr) { return qr.rank(); }, qr_);
}

Eigen::MatrixXd PivotedQr::complement() const {
  return std::visit(
      [this](const auto& qr) -> Eigen::MatrixXd {
        const Eigen::MatrixXd Q =
            qr.householderQ() * Eigen::MatrixXd::Identity(qr.rows(), qr.rows());
        return Q.rightCols(qr.rows() - rank());
      },
      qr_);
}

Eigen::MatrixXd PivotedQr::complement_components(const Eigen::MatrixXd& M) const {
  return std::visit(
      [&](const auto& qr) -> Eigen::MatrixXd {
        const auto rotate = [&](const auto& columns) -> Eigen::MatrixXd {
          const std::decay_t<decltype(columns)> rotated = qr.householderQ().adjoint() * columns;
          return rotated.bottomRows(qr.rows() - rank());
        };
        return M.cols() <= kInPlace && M.rows() <= kInPlace ? rotate(InPlace(M)) : rotate(M);
      },
      qr_);
}

Eigen::VectorXd PivotedQr::solve(const Eigen::VectorXd& b) const {
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kInPlace, 1>;
  if (const auto* qr = std::get_if<0>(&qr_)) return Column(qr->solve(Column(b)));
  return std::get<1>(qr_).solve(b);
}

Eigen::MatrixXd PivotedQr::solve_columns(const Eigen::MatrixXd& B) const {
  return std::visit([&](const auto& qr) -> Eigen::MatrixXd { return qr.solve(B); }, qr_);
}

}  // namespace stillbase
