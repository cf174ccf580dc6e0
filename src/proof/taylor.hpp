// Taylor models: what a number is over a box of N variables, as a polynomial and a rest.
//
//   x = sum over the monomials of degree <= K of coefficient * monomial in eps, + e,  |e| <= r,
//
// eps_i in [-1, 1] the same ones in every number (Makino and Berz, Int. J. Pure Appl. Math. 4,
// 2003). Unlike an interval such a number remembers how it depends on the box: parts that cancel do
// so to order K, and what is left over is of order K + 1 in the box's width.
//
// Exact in the sense of interval.hpp, on the same terms: -frounding-math, and a RoundUpward on the
// stack. Coefficients are rounded like any double; r takes the rounding errors in, each at most
// kUnit of the result or, for products, kProduct of the factors' sizes.
#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>

#include "proof/interval.hpp"
#include "proof/monomials.hpp"

namespace stillbase::proof {

template <int N, int K>
struct Taylor {
  using Terms = Monomials<N, K>;
  static constexpr int kSize = Terms::kSize;

  std::array<double, kSize> coefficient{};
  double r = 0;

  Taylor() = default;
  Taylor(double x) { coefficient[0] = x; }  // NOLINT: numbers of the model convert

  /// A form of lower degree.
  template <int M>
  explicit Taylor(const Taylor<N, M>& lower) : r(lower.r) {
    static_assert(M < K);
    std::copy(lower.coefficient.begin(), lower.coefficient.end(), coefficient.begin());
  }
  /// The variable number i over an interval.
  Taylor(const Interval& x, int i) : Taylor(proof::middle(x)) {
    coefficient[static_cast<std::size_t>(1 + i)] = radius_about(x, coefficient[0]);
  }
  /// Anything between the ends.
  static Taylor any(const Interval& x) {
    Taylor out(proof::middle(x));
    out.r = radius_about(x, out.coefficient[0]);
    return out.settle();
  }
  /// Nothing is known.
  static Taylor unbounded() {
    Taylor out;
    out.r = std::numeric_limits<double>::infinity();
    return out;
  }

  /// At the middle of the box, but for the rest.
  double c() const { return coefficient[0]; }
  double& c() { return coefficient[0]; }
  friend double middle(const Taylor& x) { return x.c(); }
  /// Of eps_i.
  double a(int i) const { return coefficient[static_cast<std::size_t>(1 + i)]; }
  /// Of eps_i eps_j, i <= j.
  double q(int i, int j) const {
    return coefficient[static_cast<std::size_t>(1 + N + i * N - i * (i - 1) / 2 + (j - i))];
  }

  bool is_bounded() const { return r < std::numeric_limits<double>::infinity(); }
  bool is_zero() const { return coefficient[0] == 0 && r == 0 && is_number(); }
  bool is_number() const {
    for (std::size_t i = 1; i < coefficient.size(); ++i) {
      if (coefficient[i] != 0) return false;
    }
    return true;
  }
  /// Sums of the sizes of the coefficients of one degree, rounded up.
  double size_of(int degree) const {
    double sum = 0;
    for (int i = Terms::first(degree); i < Terms::first(degree + 1); ++i) {
      sum += std::fabs(coefficient[static_cast<std::size_t>(i)]);
    }
    return sum;
  }
  /// Without the terms above degree M: they count as anything between their bounds.
  template <int M>
  Taylor<N, M> folded() const {
    static_assert(M <= K);
    Taylor<N, M> out;
    out.r = r;
    for (std::size_t i = 0; i < coefficient.size(); ++i) {
      if (i < out.coefficient.size()) {
        out.coefficient[i] = coefficient[i];
      } else {
        out.r += std::fabs(coefficient[i]);
      }
    }
    return out;
  }
  /// All values.
  Interval range() const {
    Interval sum = Interval(c()) + Interval(-r, r);
    for (int i = 0; i < N; ++i) {
      // a eps + q eps^2, at its ends but for a top between them.
      const double slope = std::fabs(a(i)), bend = q(i, i);
      const bool turns = slope < 2 * std::fabs(bend);
      if (!turns) {
        sum += Interval(bend) + Interval(-slope, slope);
      } else {
        sum += Interval(-slope, slope) + Interval(std::fmin(bend, 0), std::fmax(bend, 0));
      }
      for (int j = i + 1; j < N; ++j) {
        const double both = std::fabs(q(i, j));
        sum += Interval(-both, both);
      }
    }
    for (int degree = 3; degree <= K; ++degree) {
      const double size = size_of(degree);
      sum += Interval(-size, size);
    }
    return sum;
  }

  Taylor& operator+=(const Taylor& o) {
    double size = 0;
    for (std::size_t i = 0; i < coefficient.size(); ++i) {
      coefficient[i] += o.coefficient[i];
      size += std::fabs(coefficient[i]);
    }
    r += o.r + kUnit * size;
    return settle();
  }
  Taylor& operator-=(const Taylor& o) {
    double size = 0;
    for (std::size_t i = 0; i < coefficient.size(); ++i) {
      coefficient[i] -= o.coefficient[i];
      size += std::fabs(coefficient[i]);
    }
    r += o.r + kUnit * size;
    return settle();
  }
  Taylor& operator*=(const Taylor& o) { return *this = *this * o; }
  Taylor& operator/=(const Taylor& o) { return *this = *this / o; }
  friend Taylor operator+(Taylor x, const Taylor& y) { return x += y; }
  friend Taylor operator-(Taylor x, const Taylor& y) { return x -= y; }
  friend Taylor operator-(Taylor x) {
    for (double& each : x.coefficient) each = -each;
    return x;
  }

  friend Taylor operator*(const Taylor& x, const Taylor& y) {
    if (x.is_zero() || y.is_zero()) return Taylor();
    if (x.is_number()) return y.times(x);
    if (y.is_number()) return x.times(y);
    const Sizes size_x = x.sizes(), size_y = y.sizes();
    Taylor out = polynomial_product(x, y);
    double dropped = 0;
    for (int d = 1; d <= K; ++d) dropped += size_x.each[d] * size_y.from[K - d + 1];
    out.r = dropped + (size_x.from[0] * y.r + size_y.from[0] * x.r + x.r * y.r) +
            kProduct * size_x.from[0] * size_y.from[0] + kTiny;
    return out.settle();
  }
  /// The parts that are squares themselves count with their sign.
  friend Taylor square(const Taylor& x) {
    if (x.is_zero()) return Taylor();
    constexpr int kLow = K / 2;
    const Sizes size = x.sizes();
    // (low + high + e)^2: of the terms above degree K those with a low factor may have any sign,
    // the others are the square of high + e.
    double dropped = size_below(size, kLow) * x.r;
    for (int d = 1; d <= kLow; ++d) dropped += size.each[d] * size.from[K - d + 1];
    const double high = size.from[kLow + 1] + x.r, positive = high * high / 2;
    Taylor out = polynomial_product(x, x);
    out.coefficient[0] += positive;
    out.r = 2 * dropped + positive + 2 * kProduct * size.from[0] * size.from[0] +
            kUnit * std::fabs(out.coefficient[0]) + kTiny;
    out.settle();
    // Of a wide form that is all there is to say.
    const Interval whole = x.range();
    const double largest = std::fmax(std::fabs(whole.lower()), std::fabs(whole.upper()));
    const Taylor flat = any(Interval(0, largest * largest));
    return flat.r < out.r ? flat : out;
  }
  friend Taylor operator/(const Taylor& x, const Taylor& y) {
    return quotient(x, y, inverse_of(y));
  }
  /// x / y = k + (x - k y) / y with k the quotient of the middles: what is left to divide is small.
  /// @param inverse inverse_of(y)
  friend Taylor quotient(const Taylor& x, const Taylor& y, const Taylor& inverse) {
    if (x.is_zero()) return Taylor();
    const double k = x.c() / y.c();
    if (!inverse.is_bounded() || !std::isfinite(k)) return unbounded();
    return (x - y * k) * inverse + k;
  }
  /// 1/x = sum (-d)^j / c^(j+1) + (-d)^(K+1) / (c^(K+1) x), d = x - c.
  friend Taylor inverse_of(const Taylor& x) {
    const Interval whole = x.range();
    if (!x.is_bounded() || contains_zero(whole) || x.c() == 0) return unbounded();
    const Interval k = Interval(1.0) / Interval(x.c());
    std::array<Interval, K + 1> series;
    series[0] = k;
    for (std::size_t j = 1; j <= K; ++j) series[j] = -series[j - 1] * k;
    return x.expanded(series, K + 1, -series[K] / whole, Interval(1.0) / whole);
  }
  friend Taylor sin(const Taylor& x) {
    const Interval whole = x.range();
    return x.expanded(turning_series(sine(Interval(x.c())), cosine(Interval(x.c()))), K + 1,
                      turning_rest(sine(whole), cosine(whole)), sine(whole));
  }
  friend Taylor cos(const Taylor& x) {
    const Interval whole = x.range();
    return x.expanded(turning_series(cosine(Interval(x.c())), -sine(Interval(x.c()))), K + 1,
                      turning_rest(cosine(whole), -sine(whole)), cosine(whole));
  }

  /// f_0 + f_1 d + ... + f_n d^n, d = x - c: Taylor's series of a function about the middle of x,
  /// of any degree.
  /// @param f its coefficients there, the last one over all of x
  /// @param whole its values over all of x
  template <std::size_t Terms>
  friend Taylor series(const Taylor& x, const std::array<Interval, Terms>& f,
                       const Interval& whole) {
    std::array<Interval, K + 1> kept;
    kept.fill(Interval(0.0));
    constexpr std::size_t kKept = std::min<std::size_t>(Terms - 1, K + 1);
    std::copy_n(f.begin(), kKept, kept.begin());
    // What comes after it, as a multiple of the first power that is left.
    const double off = x.size_about_middle();
    double rest = 0;
    for (std::size_t j = Terms; j-- > kKept;) rest = rest * off + boost::numeric::norm(f[j]);
    return x.expanded(kept, static_cast<int>(kKept), Interval(-rest, rest), whole);
  }
  /// max(x, 0)
  friend Taylor positive_part(const Taylor& x) {
    const Interval whole = x.range();
    if (!x.is_bounded() || whole.lower() >= 0) return x;
    if (whole.upper() <= 0) return Taylor();
    if (-whole.lower() < whole.upper()) return x + any(Interval(0, -whole.lower()));
    return any(Interval(0, whole.upper()));
  }

  /// (1 - t) x + t y, 0 <= t <= 1: at most the larger of both.
  friend Taylor mixture(const Taylor& x, const Taylor& y, double t) {
    const double s = 1 - t;  // off by rounding, as the products are
    double size = 0;
    Taylor out;
    for (std::size_t i = 0; i < out.coefficient.size(); ++i) {
      const double a = x.coefficient[i], b = y.coefficient[i];
      size += std::fabs(a) + std::fabs(s * a) + std::fabs(t * b);
      out.coefficient[i] = s * a + t * b;
    }
    out.r = (s * x.r + t * y.r) + kUnit * (4 * size + x.r) + kTiny;
    return out.settle();
  }

 private:
  static constexpr double kUnit = 0x1p-52;     ///< one rounding, of the result
  static constexpr double kProduct = 0x1p-47;  ///< all roundings of a product, of both sizes
  static constexpr double kTiny = 0x1p-960;    ///< what underflows
  static_assert(N <= 3 && K <= 4, "at most 12 products make a coefficient: kProduct takes 32");

  /// Per degree, and of all from a degree on.
  struct Sizes {
    std::array<double, K + 2> each{}, from{};
  };
  Sizes sizes() const {
    Sizes out;
    for (int d = K; d >= 0; --d) {
      out.each[d] = size_of(d);
      out.from[d] = out.from[d + 1] + out.each[d];
    }
    return out;
  }
  /// Of all up to a degree.
  static double size_below(const Sizes& sizes, int degree) {
    double sum = 0;
    for (int d = 0; d <= degree; ++d) sum += sizes.each[d];
    return sum;
  }

  static double radius_about(const Interval& x, double m) {
    return std::fmax(x.upper() - m, m - x.lower());
  }

  /// Terms up to degree K, r left at zero. Written out: loops over the table cost five times that.
  static Taylor polynomial_product(const Taylor& x, const Taylor& y) {
    Taylor out;
    add_products(x.coefficient, y.coefficient, out.coefficient,
                 std::make_index_sequence<static_cast<std::size_t>(Terms::kProducts)>());
    return out;
  }
  template <std::size_t... I>
  static void add_products(const std::array<double, kSize>& x, const std::array<double, kSize>& y,
                           std::array<double, kSize>& out, std::index_sequence<I...>) {
    ((out[static_cast<std::size_t>(Terms::kTable[I].to)] +=
      x[static_cast<std::size_t>(Terms::kTable[I].x)] *
      y[static_cast<std::size_t>(Terms::kTable[I].y)]),
     ...);
  }

  /// The product with a form that does not depend on the box.
  Taylor times(const Taylor& k) const {
    const double factor = k.coefficient[0];
    double size = 0;
    Taylor out = *this;
    for (double& each : out.coefficient) {
      size += std::fabs(each);
      each *= factor;
    }
    out.r =
        std::fabs(factor) * r + size * k.r + r * k.r + 2 * kUnit * std::fabs(factor) * size + kTiny;
    return out.settle();
  }

  /// Of a function whose derivative's derivative is its negative, f and f' at the middle.
  static std::array<Interval, K + 1> turning_series(const Interval& f, const Interval& rate) {
    std::array<Interval, K + 1> out;
    Interval value = f, slope = rate;
    double factorial = 1;
    for (std::size_t j = 0; j <= K; ++j) {
      if (j > 1) factorial *= static_cast<double>(j);
      out[j] = value / factorial;
      const Interval next = -value;
      value = slope;
      slope = next;
    }
    return out;
  }
  /// Its derivative K + 1 over (K + 1)!, from f and f' over the whole range.
  static Interval turning_rest(const Interval& f, const Interval& rate) {
    Interval value = f, slope = rate;
    double factorial = 1;
    for (int j = 1; j <= K + 1; ++j) {
      factorial *= j;
      const Interval next = -value;
      value = slope;
      slope = next;
    }
    return value / factorial;
  }

  /// The variable of a form c + a eps_i; -1: it is another one.
  int only_variable() const {
    if (r != 0) return -1;
    int found = -1;
    for (int i = 1; i < kSize; ++i) {
      if (coefficient[static_cast<std::size_t>(i)] == 0) continue;
      if (i > N || found >= 0) return -1;
      found = i - 1;
    }
    return found;
  }

  double size_about_middle() const {
    double off = r;
    for (int i = 1; i < kSize; ++i) off += std::fabs(coefficient[static_cast<std::size_t>(i)]);
    return off;
  }

  /// sum f_j d^j + rest d^power, d = x - c; or only that it lies in `whole`, where that says more.
  Taylor expanded(const std::array<Interval, K + 1>& f, int power, const Interval& rest,
                  const Interval& whole) const {
    Taylor d = *this;
    d.coefficient[0] = 0;
    double open = boost::numeric::norm(rest);
    const double off = size_about_middle();
    for (int j = 0; j < power; ++j) open *= off;
    Taylor out;
    const int single = only_variable();
    if (single >= 0) {
      Interval factor(1.0);
      for (int j = 0; j <= K; ++j) {
        const Interval exact = f[static_cast<std::size_t>(j)] * factor;
        double& each = out.coefficient[static_cast<std::size_t>(Terms::power(single, j))];
        each = proof::middle(exact);
        out.r += radius_about(exact, each);
        factor *= a(single);
      }
    } else {
      out = any(f[K]);
      for (int j = K - 1; j >= 0; --j) out = out * d + any(f[static_cast<std::size_t>(j)]);
    }
    out.r += open;
    out.settle();
    const Taylor flat = any(whole);
    return flat.r < out.r ? flat : out;
  }

  /// Infinities and what comes of them are "nothing is known".
  Taylor& settle() {
    if (!(r < std::numeric_limits<double>::infinity())) *this = unbounded();
    return *this;
  }
};

/// What bounds are found of.
template <int N>
using Quadratic = Taylor<N, 2>;

/// What a box of postures is computed with.
template <int N>
using Form = Taylor<N, 4>;

}  // namespace stillbase::proof

template <int N, int K>
struct Eigen::NumTraits<stillbase::proof::Taylor<N, K>>
    : stillbase::proof::ProductTraits<stillbase::proof::Taylor<N, K>, 10, 15, 80> {};
