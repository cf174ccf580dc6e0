// Square-root-free Cholesky factorisation of small matrices in plain loops: works on any number
// type, never allocates, and has no dispatch cost at these sizes. The inner loops run down columns,
// as the elements lie in memory.
#pragma once

#include <Eigen/Core>
#include <type_traits>

namespace stillbase {

namespace cholesky_loops {

/// The two algorithms on the elements in memory: column-major, columns `stride` apart. Inlined with
/// a size that the compiler knows, their loops unroll. Products become numbers before they are
/// subtracted: of numbers with derivatives a constant has none, and an expression of two constants
/// has no length to be subtracted by.
template <class S>
[[gnu::always_inline]] inline void factorize(S* A, Eigen::Index stride, Eigen::Index n) {
  for (Eigen::Index k = 0; k < n; ++k) {
    S* const column = A + k * stride;
    const S inverse = S(1) / column[k];
    column[k] = inverse;
    for (Eigen::Index j = k + 1; j < n; ++j) {
      const S l = column[j] * inverse;
      for (Eigen::Index i = j; i < n; ++i) A[i + j * stride] -= S(column[i] * l);
    }
    for (Eigen::Index i = k + 1; i < n; ++i) column[i] *= inverse;
  }
}

/// L' x = b.
template <class S>
[[gnu::always_inline]] inline void solve_transposed(const S* L, Eigen::Index stride, Eigen::Index n,
                                                    S* b) {
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    S s = b[i];
    // The entry found last comes last: the others need not wait for it.
    for (Eigen::Index k = n - 1; k > i; --k) s -= S(L[k + i * stride] * b[k]);
    b[i] = s;
  }
}

/// L D x = b.
template <class S>
[[gnu::always_inline]] inline void solve_scaled(const S* L, Eigen::Index stride, Eigen::Index n,
                                                S* b) {
  for (Eigen::Index k = 0; k < n; ++k) {
    const S s = b[k];
    for (Eigen::Index i = k + 1; i < n; ++i) b[i] -= S(L[i + k * stride] * s);
    b[k] = s * L[k + k * stride];
  }
}

template <class S>
[[gnu::always_inline]] inline void solve(const S* L, Eigen::Index stride, Eigen::Index n, S* b) {
  solve_scaled(L, stride, n, b);
  solve_transposed(L, stride, n, b);
}

/// Calls run(n), for doubles and the sizes of usual arms with n as a constant.
template <class S, class Run>
void with_size(Eigen::Index n, Run run) {
  using std::integral_constant;
  if constexpr (std::is_same_v<S, double>) {
    switch (n) {
      case 3:
        return run(integral_constant<Eigen::Index, 3>());
      case 5:
        return run(integral_constant<Eigen::Index, 5>());
      case 6:
        return run(integral_constant<Eigen::Index, 6>());
      case 9:
        return run(integral_constant<Eigen::Index, 9>());
      case 10:
        return run(integral_constant<Eigen::Index, 10>());
    }
  }
  return run(n);
}

}  // namespace cholesky_loops

/// Replaces the lower triangle of the symmetric positive definite A by the unit triangular L of
/// A = L D L'; the diagonal holds 1/D, which is what the solves need. No square roots: they would
/// be a quarter of the time at these sizes. The upper triangle is not read.
template <class Matrix>
void factorize_cholesky(Matrix& A) {
  cholesky_loops::with_size<typename Matrix::Scalar>(
      A.rows(), [&A](auto n) { cholesky_loops::factorize(A.data(), A.outerStride(), n); });
}

/// Solves A x = b in place with the factor of factorize_cholesky(). b: contiguous.
template <class Matrix, class Vector>
void solve_cholesky(const Matrix& L, Vector&& b) {
  cholesky_loops::with_size<typename Matrix::Scalar>(
      L.rows(), [&](auto n) { cholesky_loops::solve(L.data(), L.outerStride(), n, b.data()); });
}

/// The first half of solve_cholesky(): solves L D x = b in place.
template <class Matrix, class Vector>
void solve_scaled_cholesky(const Matrix& L, Vector&& b) {
  cholesky_loops::with_size<typename Matrix::Scalar>(L.rows(), [&](auto n) {
    cholesky_loops::solve_scaled(L.data(), L.outerStride(), n, b.data());
  });
}

/// The second half: solves L' x = b in place.
template <class Matrix, class Vector>
void solve_transposed_cholesky(const Matrix& L, Vector&& b) {
  cholesky_loops::with_size<typename Matrix::Scalar>(L.rows(), [&](auto n) {
    cholesky_loops::solve_transposed(L.data(), L.outerStride(), n, b.data());
  });
}

}  // namespace stillbase
