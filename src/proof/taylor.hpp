// Taylor models: what a number is over a box of N variables, as a polynomial and a remainder.
//
//   x = sum over the monomials of degree <= K of coefficient * monomial in eps, + e,  |e| <= r,
//
// eps_i in [-1, 1] the same ones in every number (Makino and Berz, Int. J. Pure Appl. Math. 4,
// 2003). Unlike an interval such a number knows how it depends on the box: parts that cancel do so
// to order K, and the remainder is of order K + 1 in the box's width.
//
// Exact in the sense of interval.hpp, on the same terms: -frounding-math, and a RoundUpward on the
// stack. Coefficients are rounded like any double; r takes the rounding errors in.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include <stillbase/core/types.hpp>

#include "proof/interval.hpp"

namespace stillbase::proof {

/// The monomials of N variables up to degree K: by degree, within one by the variables' indices in
/// ascending order (1; x, y; xx, xy, yy; ...), and how their products are sorted.
template <int N, int K>
struct Monomials {
  static constexpr int count(int degree) {  // binomial(N + degree, N)
    int out = 1;
    for (int i = 1; i <= N; ++i) out = out * (degree + i) / i;
    return out;
  }
  static constexpr int kSize = count(K);
  /// First monomial of a degree.
  static constexpr int first(int degree) { return degree == 0 ? 0 : count(degree - 1); }

  struct Product {
    int x, y, to;
  };
  static constexpr int count_products() {
    int out = 0;
    for (int d = 0; d <= K; ++d) out += (first(d + 1) - first(d)) * count(K - d);
    return out;
  }
  static constexpr int kProducts = count_products();

  /// Powers of the variables, per monomial.
  static constexpr std::array<std::array<int, N>, kSize> powers() {
    std::array<std::array<int, N>, kSize> out{};
    std::size_t next = 0;
    for (int degree = 0; degree <= K; ++degree) {
      for (int a = degree; a >= 0; --a) {
        for (int b = degree - a; b >= 0; --b) {
          const std::array<int, 3> all{a, b, degree - a - b};
          if ((N < 3 && all[2] > 0) || (N < 2 && b > 0)) continue;
          for (std::size_t i = 0; i < N; ++i) out[next][i] = all[i];
          ++next;
        }
      }
    }
    return out;
  }
  static constexpr std::array<std::array<int, N>, kSize> kPowers = powers();

  /// eps_i^degree.
  static constexpr int power(int i, int degree) {
    std::array<int, N> wanted{};
    wanted[static_cast<std::size_t>(i)] = degree;
    int out = 0;
    while (kPowers[static_cast<std::size_t>(out)] != wanted) ++out;
    return out;
  }

  /// All products of degree <= K, sorted by where they go. Divides first: compilers bound the steps
  /// that a constant may take.
  static constexpr std::array<Product, kProducts> products() {
    std::array<Product, kProducts> out{};
    std::size_t filled = 0;
    for (std::size_t to = 0; to < kSize; ++to) {
      for (std::size_t x = 0; x < kSize; ++x) {
        std::array<int, N> rest{};
        bool divides = true;
        for (std::size_t i = 0; i < N && divides; ++i) {
          rest[i] = kPowers[to][i] - kPowers[x][i];
          divides = rest[i] >= 0;
        }
        if (!divides) continue;
        std::size_t y = 0;
        while (kPowers[y] != rest) ++y;
        out[filled++] = {static_cast<int>(x), static_cast<int>(y), static_cast<int>(to)};
      }
    }
    return out;
  }
  static constexpr std::array<Product, kProducts> kTable = products();
};

template <int N, int K>
struct Taylor {
  using Terms = Monomials<N, K>;
  static constexpr int kSize = Terms::kSize;
  /// Taylor's coefficients of a function of one variable, by order.
  using Series = std::array<Interval, K + 1>;

  std::array<double, kSize> coefficient{};
  double r = 0;  ///< bound on the remainder

  Taylor() = default;
  Taylor(double x) { coefficient[0] = x; }  // NOLINT: numbers of the model convert
  /// The variable number i over an interval.
  Taylor(const Interval& x, int i);
  /// A form of lower degree.
  template <int M>
  explicit Taylor(const Taylor<N, M>& lower) : r(lower.r) {
    static_assert(M < K);
    std::copy(lower.coefficient.begin(), lower.coefficient.end(), coefficient.begin());
  }
  /// Anything between the ends.
  static Taylor any(const Interval& x);
  /// Any number at all.
  static Taylor unbounded();

  /// At the middle of the box, but for the remainder.
  double c() const { return coefficient[0]; }
  double& c() { return coefficient[0]; }
  /// Of eps_i.
  double a(int i) const { return coefficient[static_cast<std::size_t>(1 + i)]; }
  /// Of eps_i eps_j, i <= j.
  double q(int i, int j) const {
    return coefficient[static_cast<std::size_t>(1 + N + i * N - i * (i - 1) / 2 + (j - i))];
  }

  bool is_bounded() const { return r < std::numeric_limits<double>::infinity(); }
  bool is_zero() const { return coefficient[0] == 0 && r == 0 && is_number(); }
  /// Whether no coefficient but the first counts.
  bool is_number() const {
    for (std::size_t i = 1; i < coefficient.size(); ++i) {
      if (coefficient[i] != 0) return false;
    }
    return true;
  }
  /// Sums of the sizes of the coefficients of one degree, rounded up.
  double size_of(int degree) const;
  /// Terms above degree 2 moved into the remainder.
  Taylor<N, 2> folded() const;
  /// All values.
  Interval range() const;

  Taylor& operator+=(const Taylor& o);
  Taylor& operator-=(const Taylor& o);
  Taylor& operator*=(const Taylor& o) { return *this = times(o); }
  Taylor& operator/=(const Taylor& o) { return *this = times_inverse(o, o.inverse()); }
  friend Taylor operator+(Taylor x, const Taylor& y) { return x += y; }
  friend Taylor operator-(Taylor x, const Taylor& y) { return x -= y; }
  friend Taylor operator*(const Taylor& x, const Taylor& y) { return x.times(y); }
  friend Taylor operator/(const Taylor& x, const Taylor& y) {
    return x.times_inverse(y, y.inverse());
  }
  friend Taylor operator-(Taylor x) {
    for (double& each : x.coefficient) each = -each;
    return x;
  }
  friend double middle(const Taylor& x) { return x.c(); }
  friend Taylor square(const Taylor& x) { return x.squared(); }
  friend Taylor inverse_of(const Taylor& x) { return x.inverse(); }
  /// x / y. @param inverse inverse_of(y)
  friend Taylor quotient(const Taylor& x, const Taylor& y, const Taylor& inverse) {
    return x.times_inverse(y, inverse);
  }
  friend Taylor sin(const Taylor& x) { return x.sine(); }
  friend Taylor cos(const Taylor& x) { return x.cosine(); }

  Taylor times(const Taylor& o) const;
  /// Its part that is a square itself counts with its sign.
  Taylor squared() const;
  Taylor inverse() const;
  /// x / o = k + (x - k o) / o with k the quotient of the middles: the dividend that remains is
  /// small.
  Taylor times_inverse(const Taylor& o, const Taylor& inverse_of_o) const;
  Taylor sine() const;
  Taylor cosine() const;
  Taylor positive_part() const;
  /// (1 - t) x + t o, 0 <= t <= 1: at most the larger of both.
  Taylor mixed(const Taylor& o, double t) const;
  /// sum f_j d^j + last d^power, d = x - c; or anything in `whole`, where that is narrower.
  Taylor expanded(const Series& f, int power, const Interval& last, const Interval& whole) const;
  /// Bound on |x - c|.
  double size_about_middle() const;

 private:
  static_assert(N <= 3 && K <= 4, "at most 12 products make a coefficient: kProduct takes 32");

  /// Sizes of the coefficients per degree, and of all from a degree on.
  struct Sizes {
    std::array<double, K + 2> each{}, from{};
  };
  Sizes sizes() const;
  Taylor times_number(const Taylor& k) const;
  int only_variable() const;
  Taylor& keep_bounds();
};

/// f_0 + f_1 d + ... + f_n d^n, d = x - c: Taylor's series of a function about the middle of x, of
/// any degree.
/// @param f its coefficients there, the last one over all of x
/// @param whole its values over all of x
template <int N, int K, std::size_t Terms>
Taylor<N, K> series(const Taylor<N, K>& x, const std::array<Interval, Terms>& f,
                    const Interval& whole) {
  typename Taylor<N, K>::Series kept;
  kept.fill(Interval(0.0));
  constexpr std::size_t kKept = std::min<std::size_t>(Terms - 1, K + 1);
  std::copy_n(f.begin(), kKept, kept.begin());
  // The terms after it, as a multiple of the first power that is left.
  const double off = x.size_about_middle();
  double last = 0;
  for (std::size_t j = Terms; j-- > kKept;) last = last * off + boost::numeric::norm(f[j]);
  return x.expanded(kept, static_cast<int>(kKept), Interval(-last, last), whole);
}

/// Of which bounds are found.
template <int N>
using Quadratic = Taylor<N, 2>;

/// With which a box of postures is computed.
template <int N>
using Form = Taylor<N, 4>;

extern template struct Taylor<1, 2>;
extern template struct Taylor<2, 2>;
extern template struct Taylor<3, 2>;
extern template struct Taylor<2, 4>;
extern template struct Taylor<3, 4>;

}  // namespace stillbase::proof

template <int N, int K>
struct Eigen::NumTraits<stillbase::proof::Taylor<N, K>>
    : stillbase::proof::ProductTraits<stillbase::proof::Taylor<N, K>, 10, 15, 80> {};

/// Forms are wide numbers: their matrices take as many joints as a redundant arm has.
template <int N, int K>
inline constexpr int stillbase::kMaxJointsOf<stillbase::proof::Taylor<N, K>> = 8;
