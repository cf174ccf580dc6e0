// The lines of inertia_factor_kernel.hpp for doubles, with all entries in registers.
#pragma once

#include "dynamics/cholesky.hpp"
#include "dynamics/wide_vectors.hpp"

namespace stillbase {

namespace {

/// A double that no other source file has functions for.
struct WideNumber {
  double x;

  explicit WideNumber(int value) : x(value) {}
  explicit WideNumber(double value = 0) : x(value) {}
  friend WideNumber operator*(WideNumber a, WideNumber b) { return WideNumber(a.x * b.x); }
  friend WideNumber operator/(WideNumber a, WideNumber b) { return WideNumber(a.x / b.x); }
  WideNumber& operator*=(WideNumber b) { return *this = *this * b; }
  WideNumber& operator-=(WideNumber b) {
    x -= b.x;
    return *this;
  }
};

/// Calls run(3 + joints), for usual arms as a number that the compiler knows.
template <class Run>
[[gnu::always_inline]] inline void with_equations(int joints, Run run) {
  if (joints == 7) return run(cholesky_loops::Size<10>());
  if (joints == 6) return run(cholesky_loops::Size<9>());
  return run(Eigen::Index(3 + joints));
}
template <class N>
constexpr Eigen::Index kRoomFor = 3 + kWideBodies;
template <Eigen::Index n>
constexpr Eigen::Index kRoomFor<cholesky_loops::Size<n>> = n;

/// @param entry(i, j) of the lower triangle @param A n columns of n
template <class N, class Entry>
[[gnu::always_inline]] inline void factorize_entries(N n, const Entry& entry, WideNumber* A) {
  cholesky_loops::each_below(n, [&](auto i, auto j) { A[i + j * n] = WideNumber(entry(i, j)); });
  cholesky_loops::factorize(A, n, n);
}

}  // namespace

}  // namespace stillbase
