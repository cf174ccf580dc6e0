// A number with derivatives along four directions: forward-mode differentiation of the kernel's own
// lines.
//
// Tangent{v, d} stands for v + d[0] epsilon_0 + ... + d[3] epsilon_3, where the product of any two
// epsilon is zero. Comparisons look at v alone, so a branch is differentiated as it was taken.
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace stillbase {

/// As with double, a Tangent without initialiser has no value: workspaces cost nothing.
class Tangent {
 public:
  static constexpr int kDirections = 4;

  double v;  ///< value

  Tangent() = default;
  [[gnu::always_inline]] Tangent(double value)  // NOLINT: constants mix with variables
      : v(value), d01_{}, d23_{} {}
  /// With a derivative along direction 0.
  Tangent(double value, double derivative) : v(value), d01_{derivative, 0}, d23_{} {}

  double derivative(Eigen::Index direction = 0) const {
    return direction < 2 ? d01_[direction] : d23_[direction - 2];
  }
  void set_derivative(double value, Eigen::Index direction = 0) {
    (direction < 2 ? d01_ : d23_)[direction % 2] = value;
  }

  [[gnu::always_inline]] Tangent operator-() const { return {-v, -d01_, -d23_}; }
  [[gnu::always_inline]] Tangent& operator+=(const Tangent& o) { return *this = *this + o; }
  [[gnu::always_inline]] Tangent& operator-=(const Tangent& o) { return *this = *this - o; }
  [[gnu::always_inline]] Tangent& operator*=(const Tangent& o) { return *this = *this * o; }
  [[gnu::always_inline]] Tangent& operator/=(const Tangent& o) { return *this = *this / o; }

  [[gnu::always_inline]] friend Tangent operator+(const Tangent& a, const Tangent& b) {
    return {a.v + b.v, a.d01_ + b.d01_, a.d23_ + b.d23_};
  }
  [[gnu::always_inline]] friend Tangent operator-(const Tangent& a, const Tangent& b) {
    return {a.v - b.v, a.d01_ - b.d01_, a.d23_ - b.d23_};
  }
  [[gnu::always_inline]] friend Tangent operator*(const Tangent& a, const Tangent& b) {
    return {a.v * b.v, a.d01_ * b.v + a.v * b.d01_, a.d23_ * b.v + a.v * b.d23_};
  }
  [[gnu::always_inline]] friend Tangent operator/(const Tangent& a, const Tangent& b) {
    const double quotient = a.v / b.v;
    return {quotient, (a.d01_ - quotient * b.d01_) / b.v, (a.d23_ - quotient * b.d23_) / b.v};
  }
  friend bool operator<(const Tangent& a, const Tangent& b) { return a.v < b.v; }
  friend bool operator>(const Tangent& a, const Tangent& b) { return a.v > b.v; }
  friend bool operator<=(const Tangent& a, const Tangent& b) { return a.v <= b.v; }
  friend bool operator>=(const Tangent& a, const Tangent& b) { return a.v >= b.v; }
  friend bool operator==(const Tangent& a, const Tangent& b) {
    bool is_equal = a.v == b.v;
    for (int k = 0; k < kDirections; ++k) is_equal &= a.derivative(k) == b.derivative(k);
    return is_equal;
  }
  friend bool operator!=(const Tangent& a, const Tangent& b) { return !(a == b); }

  friend Tangent sin(const Tangent& x) { return x.mapped(std::sin(x.v), std::cos(x.v)); }
  friend Tangent cos(const Tangent& x) { return x.mapped(std::cos(x.v), -std::sin(x.v)); }
  friend Tangent sqrt(const Tangent& x) {
    const double root = std::sqrt(x.v);
    return {root, x.d01_ / (2 * root), x.d23_ / (2 * root)};
  }
  friend Tangent abs(const Tangent& x) { return x.v < 0 ? -x : x; }

 private:
  /// What every processor has in one register. Arrays of Eigen's in their place stay in memory and
  /// make a second derivative three times as expensive.
  using Pair = double __attribute__((vector_size(16)));

  [[gnu::always_inline]] Tangent(double value, Pair d01, Pair d23)
      : v(value), d01_(d01), d23_(d23) {}

  Tangent mapped(double value, double slope) const { return {value, slope * d01_, slope * d23_}; }

  Pair d01_, d23_;  ///< derivatives along directions 0 and 1, 2 and 3
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
