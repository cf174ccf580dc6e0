// Eigenvalues of symmetric 3 x 3 matrices, one or several side by side.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <stillbase/core/types.hpp>

#include "core/select.hpp"

namespace stillbase {

/// A = vectors diag(values) vectors', values from largest to smallest, by Jacobi's rotations. Each
/// annihilates one entry beside the diagonal, and what is left of them shrinks quadratically. A
/// negligible one is zero at once, so that more rotations change nothing: a lane's result does not
/// depend on how many its neighbours need.
template <class S>
void descending_eigen3(Matrix3<S> A, Vector3<S>& values, Matrix3<S>& vectors) {
  using std::abs;
  using std::sqrt;
  constexpr int kMostSweeps = 8;
  constexpr double kNegligible = 1e-18;  // of the diagonal entries
  vectors.setIdentity();
  const S zero(0);
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    for (const auto& [p, q, r] : {std::array{0, 1, 2}, std::array{0, 2, 1}, std::array{1, 2, 0}}) {
      const S least = S(kNegligible) * (abs(A(p, p)) + abs(A(q, q)));
      A(p, q) = where(at_least(least, abs(A(p, q))), zero, A(p, q));
      if (A(p, q) == zero) continue;
      // tan of the angle: the smaller root of t^2 + 2 t (a_qq - a_pp) / (2 a_pq) - 1 = 0.
      const S twice = S(2) * A(p, q), apart = A(q, q) - A(p, p);
      const S root = sqrt(apart * apart + twice * twice);
      const S denominator = abs(apart) + root;
      const S size = where(at_least(S(0), denominator), S(0), abs(twice) / denominator);
      const S t = where(at_least(twice * apart, S(0)), size, -size);
      const S c = S(1) / sqrt(S(1) + t * t), s = t * c;
      A(p, p) -= t * A(p, q);
      A(q, q) += t * A(p, q);
      A(p, q) = zero;
      S &to_p = A(std::min(p, r), std::max(p, r)), &to_q = A(std::min(q, r), std::max(q, r));
      const S a_pr = to_p, a_qr = to_q;
      to_p = c * a_pr - s * a_qr;
      to_q = s * a_pr + c * a_qr;
      for (int i = 0; i < 3; ++i) {
        const S v_p = vectors(i, p), v_q = vectors(i, q);
        vectors(i, p) = c * v_p - s * v_q;
        vectors(i, q) = s * v_p + c * v_q;
      }
    }
    if (A(0, 1) == zero && A(0, 2) == zero && A(1, 2) == zero) break;
  }
  values = A.diagonal();
  const auto order = [&](int i, int j) {
    const auto ordered = at_least(values[i], values[j]);
    const S larger = where(ordered, values[i], values[j]);
    values[j] = where(ordered, values[j], values[i]);
    values[i] = larger;
    for (int k = 0; k < 3; ++k) {
      const S v = where(ordered, vectors(k, i), vectors(k, j));
      vectors(k, j) = where(ordered, vectors(k, j), vectors(k, i));
      vectors(k, i) = v;
    }
  };
  order(0, 1);
  order(0, 2);
  order(1, 2);
}

}  // namespace stillbase
