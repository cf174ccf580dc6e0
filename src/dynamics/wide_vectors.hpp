// Vectors of three numbers in registers of four, for the instruction set that the source file is
// compiled for.
#pragma once

#include "core/pack.hpp"
#include "dynamics/wide_kernel.hpp"

namespace stillbase {

namespace {

/// Room for as many vectors as bodies, in groups of four.
constexpr int kWideRoom = (kWideBodies + 3) / 4 * 4;

/// In plain vectors: of a class around them the compiler keeps copies in memory.
typedef Pack<4>::Lanes V;

const double* numbers(const Matrix3d& M) { return reinterpret_cast<const double*>(&M); }
const double* numbers(const Vector3d& v) { return reinterpret_cast<const double*>(&v); }
const double* numbers(const V& v) { return reinterpret_cast<const double*>(&v); }

/// Lanes of a by their numbers; 4 to 7: those of b.
template <int i, int j, int k, int l>
[[gnu::always_inline]] inline V lanes(const V& a, const V& b) {
  return __builtin_shufflevector(a, b, i, j, k, l);
}
template <int i, int j, int k, int l>
[[gnu::always_inline]] inline V lanes(const V& a) {
  return lanes<i, j, k, l>(a, a);
}

[[gnu::always_inline]] inline V load3(const double* p, double last = 0) {
  Pack<2>::Lanes low;
  std::memcpy(&low, p, sizeof(low));
  return __builtin_shufflevector(low, Pack<2>::Lanes{p[2], last}, 0, 1, 2, 3);
}
[[gnu::always_inline]] inline void store3(double* p, const V& a) {
  const Pack<2>::Lanes low = __builtin_shufflevector(a, a, 0, 1);
  std::memcpy(p, &low, sizeof(low));
  p[2] = a[2];
}

/// Rows of three numbers in ascending order: the fourth of each falls on the next one, whose turn
/// comes. @param next there is one
[[gnu::always_inline]] inline void store_row(double* p, const V& a, bool next) {
  if (next)
    std::memcpy(p, &a, sizeof(a));
  else
    store3(p, a);
}

/// @param count of the numbers
[[gnu::always_inline]] inline void store_some(double* p, const V& a, int count) {
  if (count >= 4) {
    std::memcpy(p, &a, sizeof(a));
  } else if (count == 3) {
    store3(p, a);
  } else {
    p[0] = a[0];
    if (count == 2) p[1] = a[1];
  }
}

[[gnu::always_inline]] inline V all(double x) { return V{x, x, x, x}; }
/// Lane i everywhere.
template <int i>
[[gnu::always_inline]] inline V all_of(const V& a) {
  return lanes<i, i, i, i>(a);
}
/// Of the first three lanes.
[[gnu::always_inline]] inline double sum(const V& a) { return a[0] + a[1] + a[2]; }
/// The fourth lane is zero.
[[gnu::always_inline]] inline V cross(const V& a, const V& b) {
  const V turned = a * lanes<1, 2, 0, 3>(b) - lanes<1, 2, 0, 3>(a) * b;
  return lanes<1, 2, 0, 3>(turned);
}

/// Columns.
struct Wide3x3 {
  V c0, c1, c2;
};
[[gnu::always_inline]] inline Wide3x3 load3x3(const double* p) {
  return {load3(p), load3(p + 3), load3(p + 6)};
}
/// See store_row().
[[gnu::always_inline]] inline void store3x3(double* p, const Wide3x3& M, bool next) {
  store_row(p, M.c0, true);
  store_row(p + 3, M.c1, true);
  store_row(p + 6, M.c2, next);
}
/// M x. @param stride between the entries of x
[[gnu::always_inline]] inline V times(const Wide3x3& M, const double* x, int stride = 1) {
  return M.c0 * all(x[0]) + (M.c1 * all(x[stride]) + M.c2 * all(x[2 * stride]));
}
[[gnu::always_inline]] inline V times(const Wide3x3& M, const V& x) {
  return M.c0 * all_of<0>(x) + (M.c1 * all_of<1>(x) + M.c2 * all_of<2>(x));
}
/// M N.
[[gnu::always_inline]] inline Wide3x3 times(const Wide3x3& M, const Wide3x3& N) {
  const double* const entries = numbers(N.c0);
  return {times(M, entries), times(M, entries + 4), times(M, entries + 8)};
}
/// The rows of four columns.
[[gnu::always_inline]] inline void transpose(V* c) {
  const V low01 = lanes<0, 4, 2, 6>(c[0], c[1]), high01 = lanes<1, 5, 3, 7>(c[0], c[1]);
  const V low23 = lanes<0, 4, 2, 6>(c[2], c[3]), high23 = lanes<1, 5, 3, 7>(c[2], c[3]);
  c[0] = lanes<0, 1, 4, 5>(low01, low23);
  c[1] = lanes<0, 1, 4, 5>(high01, high23);
  c[2] = lanes<2, 3, 6, 7>(low01, low23);
  c[3] = lanes<2, 3, 6, 7>(high01, high23);
}

}  // namespace

}  // namespace stillbase
