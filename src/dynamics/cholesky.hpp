// Square-root-free Cholesky factorisation of small matrices in plain loops: works on any number
// type, never allocates, and has no dispatch cost at these sizes. The inner loops run down columns,
// as the elements lie in memory.
#pragma once

#include <Eigen/Core>

namespace stillbase {

/// Replaces the lower triangle of the symmetric positive definite A by the unit triangular L of
/// A = L D L'; the diagonal holds 1/D, which is what the solves need. No square roots: they would
/// be a quarter of the time at these sizes. The upper triangle is not read.
template <class Matrix>
void factorize_cholesky(Matrix& A) {
  using S = typename Matrix::Scalar;
  const Eigen::Index n = A.rows();
  for (Eigen::Index k = 0; k < n; ++k) {
    const S inverse = S(1) / A(k, k);
    A(k, k) = inverse;
    for (Eigen::Index j = k + 1; j < n; ++j) {
      const S l = A(j, k) * inverse;
      for (Eigen::Index i = j; i < n; ++i) A(i, j) -= A(i, k) * l;
    }
    for (Eigen::Index i = k + 1; i < n; ++i) A(i, k) *= inverse;
  }
}

/// Solves A x = b in place with the factor of factorize_cholesky().
template <class Matrix, class Vector>
void solve_cholesky(const Matrix& L, Vector&& b) {
  using S = typename Matrix::Scalar;
  const Eigen::Index n = L.rows();
  for (Eigen::Index k = 0; k < n; ++k) {
    const S s = b(k);
    for (Eigen::Index i = k + 1; i < n; ++i) b(i) -= L(i, k) * s;
    b(k) = s * L(k, k);
  }
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    S s = b(i);
    // The entry found last comes last: the others need not wait for it.
    for (Eigen::Index k = n - 1; k > i; --k) s -= L(k, i) * b(k);
    b(i) = s;
  }
}

}  // namespace stillbase
