// Cholesky factorisation of small matrices in plain loops: works on any number type, never
// allocates, and has no dispatch cost at these sizes. The inner loops run down columns, as the
// elements lie in memory.
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace stillbase {

/// Replaces the lower triangle of the symmetric positive definite A by L with A = L L'; the
/// diagonal holds 1/L_ii, which is what the solves need. The upper triangle is not read.
template <class Matrix>
void factorize_cholesky(Matrix& A) {
  using S = typename Matrix::Scalar;
  using std::sqrt;
  const Eigen::Index n = A.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index k = 0; k < j; ++k) {
      const S a = A(j, k);
      for (Eigen::Index i = j; i < n; ++i) A(i, j) -= A(i, k) * a;
    }
    const S inverse = S(1) / sqrt(A(j, j));
    A(j, j) = inverse;
    for (Eigen::Index i = j + 1; i < n; ++i) A(i, j) *= inverse;
  }
}

/// Solves A x = b in place with the factor of factorize_cholesky().
template <class Matrix, class Vector>
void solve_cholesky(const Matrix& L, Vector&& b) {
  using S = typename Matrix::Scalar;
  const Eigen::Index n = L.rows();
  for (Eigen::Index k = 0; k < n; ++k) {
    const S s = b(k) * L(k, k);
    b(k) = s;
    for (Eigen::Index i = k + 1; i < n; ++i) b(i) -= L(i, k) * s;
  }
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    S s = b(i);
    for (Eigen::Index k = i + 1; k < n; ++k) s -= L(k, i) * b(k);
    b(i) = s * L(i, i);
  }
}

}  // namespace stillbase
