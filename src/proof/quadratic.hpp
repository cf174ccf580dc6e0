// Quadratic forms: what a number is, to second order, over a box of N variables.
//
//   x = c + sum a_i eps_i + sum_{i<=j} q_ij eps_i eps_j + e,  |e| <= r,
//
// eps_i in [-1, 1] the same ones in every number: a Taylor model of second order (Makino and Berz,
// Int. J. Pure Appl. Math. 4, 2003). Unlike an interval a form remembers how it depends on the box:
// parts that cancel do so to second order, and what is left over is of third order in the box's
// width.
//
// Exact in the sense of interval.hpp, on the same terms: -frounding-math, and a RoundUpward on the
// stack. c, a and q are rounded like any double; r takes the rounding errors in, each at most kUnit
// of the result or, for products, of the factors' sizes.
#pragma once

#include "proof/interval.hpp"

namespace stillbase::proof {

template <int N>
struct Quadratic {
  static constexpr int kPairs = N * (N + 1) / 2;

  double c = 0;
  std::array<double, N> a{};
  std::array<double, kPairs> q{};  ///< row by row, upper triangle
  double r = 0;

  Quadratic() = default;
  Quadratic(double x) : c(x) {}  // NOLINT: numbers of the model convert

  /// The variable number i over an interval.
  Quadratic(const Interval& x, int i) : c(middle(x)) {
    a[static_cast<std::size_t>(i)] = radius_about(x, c);
  }
  /// Anything between the ends.
  static Quadratic any(const Interval& x) {
    Quadratic out(middle(x));
    out.r = radius_about(x, out.c);
    return out.settle();
  }
  /// Nothing is known.
  static Quadratic unbounded() {
    Quadratic out;
    out.r = std::numeric_limits<double>::infinity();
    return out;
  }

  static constexpr int pair(int i, int j) { return i * N - i * (i - 1) / 2 + (j - i); }  // i <= j

  bool is_bounded() const { return r < std::numeric_limits<double>::infinity(); }
  bool is_zero() const {
    bool zero = c == 0 && r == 0;
    for (const double x : a) zero = zero && x == 0;
    for (const double x : q) zero = zero && x == 0;
    return zero;
  }
  bool is_number() const {
    bool number = true;
    for (const double x : a) number = number && x == 0;
    for (const double x : q) number = number && x == 0;
    return number;
  }
  /// Sums of the sizes of the coefficients, rounded up.
  double linear_size() const {
    double sum = 0;
    for (const double x : a) sum += std::fabs(x);
    return sum;
  }
  double square_size() const {
    double sum = 0;
    for (const double x : q) sum += std::fabs(x);
    return sum;
  }
  /// All values.
  Interval range() const {
    Interval sum = Interval(c) + Interval(-r, r);
    for (int i = 0; i < N; ++i) {
      // a eps + q eps^2, at its ends but for a top between them.
      const double slope = std::fabs(a[i]), bend = q[pair(i, i)];
      const bool turns = slope < 2 * std::fabs(bend);
      if (!turns) {
        sum += Interval(bend) + Interval(-slope, slope);
      } else {
        sum += Interval(-slope, slope) + Interval(std::fmin(bend, 0), std::fmax(bend, 0));
      }
      for (int j = i + 1; j < N; ++j) {
        const double both = std::fabs(q[pair(i, j)]);
        sum += Interval(-both, both);
      }
    }
    return sum;
  }

  Quadratic& operator+=(const Quadratic& o) {
    c += o.c;
    double size = std::fabs(c);
    for (std::size_t i = 0; i < a.size(); ++i) {
      a[i] += o.a[i];
      size += std::fabs(a[i]);
    }
    for (std::size_t i = 0; i < q.size(); ++i) {
      q[i] += o.q[i];
      size += std::fabs(q[i]);
    }
    r += o.r + kUnit * size;
    return settle();
  }
  Quadratic& operator-=(const Quadratic& o) { return *this += -o; }
  Quadratic& operator*=(const Quadratic& o) { return *this = *this * o; }
  Quadratic& operator/=(const Quadratic& o) { return *this = *this / o; }
  friend Quadratic operator+(Quadratic x, const Quadratic& y) { return x += y; }
  friend Quadratic operator-(Quadratic x, const Quadratic& y) { return x += -y; }
  friend Quadratic operator-(Quadratic x) {
    x.c = -x.c;
    for (double& coefficient : x.a) coefficient = -coefficient;
    for (double& coefficient : x.q) coefficient = -coefficient;
    return x;
  }

  friend Quadratic operator*(const Quadratic& x, const Quadratic& y) {
    if (x.is_zero() || y.is_zero()) return Quadratic();
    if (x.is_number()) return y.times(x);
    if (y.is_number()) return x.times(y);
    Quadratic out;
    out.c = x.c * y.c;
    for (int i = 0; i < N; ++i) {
      out.a[i] = x.c * y.a[i] + y.c * x.a[i];
      for (int j = i; j < N; ++j) {
        const double mixed = i == j ? x.a[i] * y.a[i] : x.a[i] * y.a[j] + x.a[j] * y.a[i];
        const int k = pair(i, j);
        out.q[k] = x.c * y.q[k] + y.c * x.q[k] + mixed;
      }
    }
    const double linear_x = x.linear_size(), linear_y = y.linear_size();
    const double square_x = x.square_size(), square_y = y.square_size();
    const double size_x = std::fabs(x.c) + linear_x + square_x;
    const double size_y = std::fabs(y.c) + linear_y + square_y;
    out.r = (linear_x * square_y + square_x * linear_y + square_x * square_y) +
            (size_x * y.r + size_y * x.r + x.r * y.r) + kProduct * size_x * size_y + kTiny;
    return out.settle();
  }
  /// The parts that are squares themselves count with their sign.
  friend Quadratic square(const Quadratic& x) {
    if (x.is_zero()) return Quadratic();
    const double linear = x.linear_size(), squares = x.square_size();
    const double size = std::fabs(x.c) + linear + squares;
    const double positive = (squares * squares + x.r * x.r) / 2;  // of twice that, from zero on
    Quadratic out = x;
    out.r = 0;
    out = out * out;
    out.c += positive;
    out.r = 2 * linear * squares + 2 * size * x.r + positive + 2 * kProduct * size * size +
            kUnit * std::fabs(out.c) + kTiny;
    out.settle();
    // Of a wide form that is all there is to say.
    const Interval whole = x.range();
    const double largest = std::fmax(std::fabs(whole.lower()), std::fabs(whole.upper()));
    const Quadratic flat = any(Interval(0, largest * largest));
    return flat.r < out.r ? flat : out;
  }
  friend Quadratic operator/(const Quadratic& x, const Quadratic& y) {
    return quotient(x, y, inverse_of(y));
  }
  /// x / y = k + (x - k y) / y with k the quotient of the middles: what is left to divide is small.
  /// @param inverse inverse_of(y)
  friend Quadratic quotient(const Quadratic& x, const Quadratic& y, const Quadratic& inverse) {
    if (x.is_zero()) return Quadratic();
    const double k = x.c / y.c;
    if (!inverse.is_bounded() || !std::isfinite(k)) return unbounded();
    return (x - y * k) * inverse + k;
  }
  /// 1/x = 1/c - d/c^2 + d^2/c^3 - d^3/(c^3 x), d = x - c.
  friend Quadratic inverse_of(const Quadratic& x) {
    const Interval whole = x.range();
    if (!x.is_bounded() || contains_zero(whole) || x.c == 0) return unbounded();
    const Interval k = Interval(1.0) / Interval(x.c);
    return x.expanded({k, -k * k, k * k * k}, -(k * k * k) / whole, Interval(1.0) / whole);
  }
  friend Quadratic sin(const Quadratic& x) {
    const Interval s = sine(Interval(x.c)), c = cosine(Interval(x.c)), whole = x.range();
    return x.expanded({s, c, -s / 2.0}, -cosine(whole) / 6.0, sine(whole));
  }
  friend Quadratic cos(const Quadratic& x) {
    const Interval s = sine(Interval(x.c)), c = cosine(Interval(x.c)), whole = x.range();
    return x.expanded({c, -s, -c / 2.0}, sine(whole) / 6.0, cosine(whole));
  }

  /// f_0 + f_1 d + f_2 d^2 + f_3 d^3, d = x - c: Taylor's series of a function about the middle of
  /// x.
  /// @param f its coefficients there, the last one over all of x
  /// @param whole its values over all of x
  friend Quadratic series(const Quadratic& x, const std::array<Interval, 4>& f,
                          const Interval& whole) {
    return x.expanded({f[0], f[1], f[2]}, f[3], whole);
  }
  /// max(x, 0)
  friend Quadratic positive_part(const Quadratic& x) {
    const Interval whole = x.range();
    if (!x.is_bounded() || whole.lower() >= 0) return x;
    if (whole.upper() <= 0) return Quadratic();
    if (-whole.lower() < whole.upper()) return x + any(Interval(0, -whole.lower()));
    return any(Interval(0, whole.upper()));
  }

  /// (1 - t) x + t y, 0 <= t <= 1: at most the larger of both.
  friend Quadratic mixture(const Quadratic& x, const Quadratic& y, double t) {
    const double s = 1 - t;  // off by rounding, as the products are
    double size = 0;
    const auto mixed = [&](double a, double b) {
      size += std::fabs(a) + std::fabs(s * a) + std::fabs(t * b);
      return s * a + t * b;
    };
    Quadratic out(mixed(x.c, y.c));
    for (std::size_t i = 0; i < x.a.size(); ++i) out.a[i] = mixed(x.a[i], y.a[i]);
    for (std::size_t i = 0; i < x.q.size(); ++i) out.q[i] = mixed(x.q[i], y.q[i]);
    out.r = (s * x.r + t * y.r) + kUnit * (4 * size + x.r) + kTiny;
    return out.settle();
  }

 private:
  static constexpr double kUnit = 0x1p-52;     ///< one rounding, of the result
  static constexpr double kProduct = 0x1p-47;  ///< all roundings of a product, of both sizes
  static constexpr double kTiny = 0x1p-960;    ///< what underflows

  static double radius_about(const Interval& x, double m) {
    return std::fmax(x.upper() - m, m - x.lower());
  }

  /// The product with a form that does not depend on the box.
  Quadratic times(const Quadratic& k) const {
    const double size = std::fabs(c) + linear_size() + square_size();
    Quadratic out = *this;
    out.c *= k.c;
    for (double& coefficient : out.a) coefficient *= k.c;
    for (double& coefficient : out.q) coefficient *= k.c;
    out.r = std::fabs(k.c) * r + size * k.r + r * k.r + 2 * kUnit * std::fabs(k.c) * size + kTiny;
    return out.settle();
  }

  /// f_0 + f_1 d + f_2 d^2 + rest d^3, d = x - c; or only that it lies in `whole`, where that says
  /// more.
  Quadratic expanded(const std::array<Interval, 3>& f, const Interval& rest,
                     const Interval& whole) const {
    Quadratic d = *this;
    d.c = 0;
    const double off = linear_size() + square_size() + r;
    const double cube = off * off * off;
    Quadratic out = any(f[0]) + any(f[1]) * d + any(f[2]) * (d * d);
    out.r += boost::numeric::norm(rest) * cube;
    out.settle();
    const Quadratic flat = any(whole);
    return flat.r < out.r ? flat : out;
  }

  /// Infinities and what comes of them are "nothing is known".
  Quadratic& settle() {
    if (!(r < std::numeric_limits<double>::infinity())) *this = unbounded();
    return *this;
  }
};

}  // namespace stillbase::proof

template <int N>
struct Eigen::NumTraits<stillbase::proof::Quadratic<N>>
    : stillbase::proof::ProductTraits<stillbase::proof::Quadratic<N>, 10, 15, 80> {};
