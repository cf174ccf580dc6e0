// Square-root-free Cholesky factorisation of small matrices: works on any number type, never
// allocates, and has no dispatch cost at these sizes. In plain loops, the inner ones down columns,
// as the elements lie in memory; for sizes that the compiler knows written out, in registers.
#pragma once

#include <Eigen/Core>
#include <type_traits>

namespace stillbase {

namespace cholesky_loops {

// For lambdas: with a call in between, the copies of in_registers() would be in memory.
#define STILLBASE_INLINE __attribute__((always_inline))

/// A size that the compiler knows.
template <Eigen::Index n>
using Size = std::integral_constant<Eigen::Index, n>;

template <Eigen::Index i>
constexpr Size<i + 1> after(Size<i>) {
  return {};
}
constexpr Eigen::Index after(Eigen::Index i) { return i + 1; }

/// Calls step(i) for i = from to end - 1, between Sizes written out one after the other.
template <class Step>
[[gnu::always_inline]] inline void up(Eigen::Index from, Eigen::Index end, const Step& step) {
  for (Eigen::Index i = from; i < end; ++i) step(i);
}
template <Eigen::Index from, Eigen::Index end, class Step>
[[gnu::always_inline]] inline void up(Size<from>, Size<end>, const Step& step) {
  if constexpr (from < end) {
    step(Size<from>());
    up(Size<from + 1>(), Size<end>(), step);
  }
}

/// The same from the other end.
template <class Step>
[[gnu::always_inline]] inline void down(Eigen::Index from, Eigen::Index end, const Step& step) {
  for (Eigen::Index i = end - 1; i >= from; --i) step(i);
}
template <Eigen::Index from, Eigen::Index end, class Step>
[[gnu::always_inline]] inline void down(Size<from>, Size<end>, const Step& step) {
  if constexpr (from < end) {
    step(Size<end - 1>());
    down(Size<from>(), Size<end - 1>(), step);
  }
}

inline constexpr Size<0> kFirst;

/// The algorithms: column-major, columns `stride` apart. Products become numbers before they are
/// subtracted: of numbers with derivatives a constant has none, and an expression of two constants
/// has no length to be subtracted by.
template <class S, class N>
[[gnu::always_inline]] inline void factorize(S* A, Eigen::Index stride, N n) {
  up(kFirst, n, [=](auto k) STILLBASE_INLINE {
    S* const column = A + k * stride;
    const S inverse = S(1) / column[k];
    column[k] = inverse;
    up(after(k), n, [=](auto j) STILLBASE_INLINE {
      const S l = column[j] * inverse;
      up(j, n, [=](auto i) STILLBASE_INLINE { A[i + j * stride] -= S(column[i] * l); });
    });
    up(after(k), n, [=](auto i) STILLBASE_INLINE { column[i] *= inverse; });
  });
}

/// L D x = b.
template <class S, class N>
[[gnu::always_inline]] inline void solve_scaled(const S* L, Eigen::Index stride, N n, S* b) {
  up(kFirst, n, [=](auto k) STILLBASE_INLINE {
    const S s = b[k];
    up(after(k), n, [=](auto i) STILLBASE_INLINE { b[i] -= S(L[i + k * stride] * s); });
    b[k] = s * L[k + k * stride];
  });
}

/// L' x = b.
template <class S, class N>
[[gnu::always_inline]] inline void solve_transposed(const S* L, Eigen::Index stride, N n, S* b) {
  down(kFirst, n, [=](auto i) STILLBASE_INLINE {
    S s = b[i];
    // The entry found last comes last: the others need not wait for it.
    down(after(i), n, [&](auto k) STILLBASE_INLINE { s -= S(L[k + i * stride] * b[k]); });
    b[i] = s;
  });
}

/// Calls run(x, n) with a copy x of the n elements at b that the compiler can keep in registers, if
/// it knows n; else with b itself.
template <class S, class N, class Run>
[[gnu::always_inline]] inline void in_registers(S* b, N n, Run run) {
  if constexpr (std::is_same_v<N, Eigen::Index>) {
    run(b);
  } else {
    S x[N::value];
    up(kFirst, n, [&](auto i) STILLBASE_INLINE { x[i] = b[i]; });
    run(x);
    up(kFirst, n, [&](auto i) STILLBASE_INLINE { b[i] = x[i]; });
  }
}

/// Calls step(i, j) for the lower triangle.
template <class N, class Step>
[[gnu::always_inline]] inline void each_below(N n, const Step& step) {
  up(kFirst, n,
     [&](auto j) STILLBASE_INLINE { up(j, n, [&](auto i) STILLBASE_INLINE { step(i, j); }); });
}

/// The same of the lower triangle of A, as run(A, stride).
template <class S, class N, class Run>
[[gnu::always_inline]] inline void triangle_in_registers(S* A, Eigen::Index stride, N n, Run run) {
  if constexpr (std::is_same_v<N, Eigen::Index>) {
    run(A, stride);
  } else {
    S x[N::value * N::value];
    each_below(n, [&](auto i, auto j) STILLBASE_INLINE { x[i + j * n] = A[i + j * stride]; });
    run(x, n);
    each_below(n, [&](auto i, auto j) STILLBASE_INLINE { A[i + j * stride] = x[i + j * n]; });
  }
}

/// Calls run(n), for doubles and the sizes of usual arms with n as a Size.
template <class S, class Run>
void with_size(Eigen::Index n, Run run) {
  if constexpr (std::is_same_v<S, double>) {
    switch (n) {
      case 3:
        return run(Size<3>());
      case 5:
        return run(Size<5>());
      case 6:
        return run(Size<6>());
      case 9:
        return run(Size<9>());
      case 10:
        return run(Size<10>());
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
  using namespace cholesky_loops;
  with_size<typename Matrix::Scalar>(A.rows(), [&A](auto n) {
    triangle_in_registers(A.data(), A.outerStride(), n,
                          [n](auto* x, Eigen::Index stride)
                              STILLBASE_INLINE { factorize(x, stride, n); });
  });
}

/// The same of the matrix whose lower triangle is entry(i, j, n), n its size, into L, whose columns
/// follow each other. Apart from factorize_cholesky(): made by way of it, the factor of the inertia
/// matrix took a tenth longer.
template <class Matrix, class Entry>
void factorize_cholesky_of(const Entry& entry, Matrix& L) {
  using namespace cholesky_loops;
  using S = typename Matrix::Scalar;
  with_size<S>(L.rows(), [&](auto n) {
    if constexpr (std::is_same_v<decltype(n), Eigen::Index>) {
      each_below(n, [&](Eigen::Index i, Eigen::Index j) { L(i, j) = entry(i, j, n); });
      factorize(L.data(), L.outerStride(), n);
    } else {
      S x[n * n];
      S* const out = L.data();
      each_below(n, [&](auto i, auto j) STILLBASE_INLINE { x[i + j * n] = entry(i, j, n); });
      factorize(x, n, n);
      each_below(n, [&](auto i, auto j) STILLBASE_INLINE { out[i + j * n] = x[i + j * n]; });
    }
  });
}

/// Solves L D x = b in place with the factor of factorize_cholesky(). b: contiguous.
template <class Matrix, class Vector>
void solve_scaled_cholesky(const Matrix& L, Vector&& b) {
  using namespace cholesky_loops;
  with_size<typename Matrix::Scalar>(L.rows(), [&](auto n) {
    in_registers(b.data(), n,
                 [&](auto* x) STILLBASE_INLINE { solve_scaled(L.data(), L.outerStride(), n, x); });
  });
}

/// Solves L' x = b in place.
template <class Matrix, class Vector>
void solve_transposed_cholesky(const Matrix& L, Vector&& b) {
  using namespace cholesky_loops;
  with_size<typename Matrix::Scalar>(L.rows(), [&](auto n) {
    in_registers(b.data(), n, [&](auto* x) STILLBASE_INLINE {
      solve_transposed(L.data(), L.outerStride(), n, x);
    });
  });
}

/// Solves A x = b in place: both halves.
template <class Matrix, class Vector>
void solve_cholesky(const Matrix& L, Vector&& b) {
  using namespace cholesky_loops;
  with_size<typename Matrix::Scalar>(L.rows(), [&](auto n) {
    in_registers(b.data(), n, [&](auto* x) STILLBASE_INLINE {
      solve_scaled(L.data(), L.outerStride(), n, x);
      solve_transposed(L.data(), L.outerStride(), n, x);
    });
  });
}

}  // namespace stillbase

#undef STILLBASE_INLINE
