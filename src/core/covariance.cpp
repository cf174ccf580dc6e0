#include "core/covariance.hpp"

#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/linear_algebra.hpp>

namespace stillbase {

std::optional<CovarianceObjection> covariance_objection(const Eigen::MatrixXd& A) {
  const int n = static_cast<int>(A.rows());
  for (int i = 0; i < n; ++i) {
    if (A(i, i) >= 0) continue;
    return {{i, fmt::format("[{0}][{0}]: is {1}; a variance is not negative", i, A(i, i))}};
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < i; ++j) {
      const double size = std::sqrt(A(i, i) * A(j, j));
      if (!(std::abs(A(i, j) - A(j, i)) <= kCovarianceTolerance * size)) {
        return {{i, fmt::format("[{0}][{1}]: is {2}, but [{1}][{0}] is {3}; a covariance is "
                                "symmetric",
                                i, j, A(i, j), A(j, i))}};
      }
      if (!(std::abs(A(i, j)) <= (1 + kCovarianceTolerance) * size)) {
        return {{i, fmt::format("[{0}][{1}]: is {2}; must be at most {3:.6g} in size, the product "
                                "of the deviations {0} and {1}, or the covariance is not positive "
                                "semidefinite",
                                i, j, A(i, j), size)}};
      }
    }
  }
  const Eigen::VectorXd scale =
      A.diagonal().unaryExpr([](double v) { return v > 0 ? 1 / std::sqrt(v) : 0; });
  const double least =
      symmetric_eigenvalues(scale.asDiagonal() * A * scale.asDiagonal()).minCoeff();
  if (least >= -kCovarianceTolerance) return std::nullopt;
  return {{0, fmt::format(": is not positive semidefinite: the least eigenvalue of its "
                          "correlations is {:.4g}",
                          least)}};
}

}  // namespace stillbase
