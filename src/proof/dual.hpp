// A value over a box with its partial derivatives over the box (forward mode), all of them
// intervals, on the terms of interval.hpp.
#pragma once

#include <array>

#include <stillbase/core/types.hpp>

#include "proof/interval.hpp"

namespace stillbase::proof {

/// One type for every number of variables: derivatives beyond `count` are zero and cost nothing.
struct Dual {
  static constexpr int kMaxVariables = 3;

  Interval v{0.0};  ///< value
  int count = 0;    ///< of variables that it may depend on
  std::array<Interval, kMaxVariables> d{};

  Dual() = default;
  Dual(double x) : v(x) {}  // NOLINT: numbers of the model convert
  explicit Dual(const Interval& x) : v(x) {}
  /// The variable number i of `variables`.
  Dual(const Interval& x, int i, int variables) : v(x), count(variables) {
    d[static_cast<std::size_t>(i)] = Interval(1.0);
  }
  /// Any value, any derivatives.
  static Dual unbounded();

  Dual& operator+=(const Dual& o);
  Dual& operator-=(const Dual& o);
  Dual& operator*=(const Dual& o);
  Dual& operator/=(const Dual& o);
  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator*(Dual a, const Dual& b) { return a *= b; }
  friend Dual operator/(Dual a, const Dual& b) { return a /= b; }
  friend Dual operator-(const Dual& a);
};

inline double middle(const Dual& x) { return middle(x.v); }
Dual square(const Dual& x);
/// Unbounded where x contains zero.
Dual inverse_of(const Dual& x);
/// x / y, unbounded where y contains zero. The third argument, inverse_of(y), is not used: the
/// quotient itself is narrower.
Dual quotient(const Dual& x, const Dual& y, const Dual& inverse);
Dual sin(const Dual& x);
Dual cos(const Dual& x);

}  // namespace stillbase::proof

template <>
struct Eigen::NumTraits<stillbase::proof::Dual>
    : stillbase::proof::ProductTraits<stillbase::proof::Dual, 8, 20, 60> {};

/// Duals are wide: their matrices take the joints of a redundant arm and one more.
template <>
inline constexpr int stillbase::kMaxJointsOf<stillbase::proof::Dual> = 8;
