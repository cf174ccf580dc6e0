// Twists and momenta in wide registers.
#pragma once

#include "dynamics/wide_vectors.hpp"

namespace stillbase {

namespace {

/// Linear and angular part of a twist or a momentum, about the base centroid.
struct WideSpatial {
  V v, w;
};

[[gnu::always_inline]] inline void add(WideSpatial& a, const WideSpatial& b) {
  a.v += b.v;
  a.w += b.w;
}

/// Momentum of a body about the base centroid. @param c its centroid @param I about that
[[gnu::always_inline]] inline WideSpatial momentum_of(const WideSpatial& twist, const V& c,
                                                      const Wide3x3& I, double mass) {
  const V p = (twist.v + cross(twist.w, c)) * all(mass);
  return {p, cross(c, p) + times(I, twist.w)};
}

}  // namespace

}  // namespace stillbase
