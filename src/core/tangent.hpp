// A number with one directional derivative: forward-mode differentiation of the kernel's own lines.
//
// Tangent{v, d} stands for v + d epsilon, epsilon^2 = 0. Comparisons look at v alone, so a branch
// is differentiated as it was taken.
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace stillbase {

/// As with double, a Tangent without initialiser has no value: workspaces cost nothing.
struct Tangent {
  double v;  ///< value
  double d;  ///< derivative

  Tangent() = default;
  Tangent(double value) : v(value), d(0) {}  // NOLINT: constants mix with variables
  Tangent(double value, double derivative) : v(value), d(derivative) {}

  Tangent operator-() const { return {-v, -d}; }
  Tangent& operator+=(const Tangent& o) { return *this = {v + o.v, d + o.d}; }
  Tangent& operator-=(const Tangent& o) { return *this = {v - o.v, d - o.d}; }
  Tangent& operator*=(const Tangent& o) { return *this = {v * o.v, d * o.v + v * o.d}; }
  Tangent& operator/=(const Tangent& o) {
    const double quotient = v / o.v;
    return *this = {quotient, (d - quotient * o.d) / o.v};
  }

  friend Tangent operator+(Tangent a, const Tangent& b) { return a += b; }
  friend Tangent operator-(Tangent a, const Tangent& b) { return a -= b; }
  friend Tangent operator*(Tangent a, const Tangent& b) { return a *= b; }
  friend Tangent operator/(Tangent a, const Tangent& b) { return a /= b; }
  friend bool operator<(const Tangent& a, const Tangent& b) { return a.v < b.v; }
  friend bool operator>(const Tangent& a, const Tangent& b) { return a.v > b.v; }
  friend bool operator<=(const Tangent& a, const Tangent& b) { return a.v <= b.v; }
  friend bool operator>=(const Tangent& a, const Tangent& b) { return a.v >= b.v; }
  friend bool operator==(const Tangent& a, const Tangent& b) { return a.v == b.v && a.d == b.d; }
  friend bool operator!=(const Tangent& a, const Tangent& b) { return !(a == b); }

  friend Tangent sin(const Tangent& x) { return {std::sin(x.v), std::cos(x.v) * x.d}; }
  friend Tangent cos(const Tangent& x) { return {std::cos(x.v), -std::sin(x.v) * x.d}; }
  friend Tangent sqrt(const Tangent& x) {
    const double root = std::sqrt(x.v);
    return {root, x.d / (2 * root)};
  }
  friend Tangent abs(const Tangent& x) { return x.v < 0 ? -x : x; }
};

/// The plain value of a number, whatever it carries along.
inline double value_of_number(double x) { return x; }
inline double value_of_number(const Tangent& x) { return x.v; }
/// Of other differentiating numbers (the tests' oracles).
template <class S>
auto value_of_number(const S& x) -> decltype(double(x.value())) {
  return x.value();
}

}  // namespace stillbase

template <>
struct Eigen::NumTraits<stillbase::Tangent> : Eigen::NumTraits<double> {
  using Real = stillbase::Tangent;
  using NonInteger = stillbase::Tangent;
  using Nested = stillbase::Tangent;
  using Literal = double;
};
