// Intervals whose ends are rounded outwards, and first derivatives over them.
//
// Everything here is exact in one sense: the true value lies between the ends, for the numbers of
// the robot's data as doubles. That needs two things of whoever uses it: the source is compiled
// with -frounding-math (CMakeLists.txt), and a RoundUpward stands on the stack. Boost's ends are
// then computed in the one mode "upward" (the lower end as the negative of a negated sum or
// product).
//
// sin and cos are ours: Boost's widen nothing, and trust the library to obey the rounding mode.
// Here the library is called in its default mode, where its error is below one unit in the last
// place (GNU C Library manual, 19.7), and the result is moved outwards by two.
#pragma once

#include <Eigen/Core>
#include <array>
#include <boost/numeric/interval.hpp>
#include <cfenv>
#include <cmath>
#include <limits>

namespace stillbase::proof {

namespace interval_lib = boost::numeric::interval_lib;

using Interval = boost::numeric::interval<
    double, interval_lib::policies<
                interval_lib::save_state_nothing<interval_lib::rounded_arith_opp<double>>,
                interval_lib::checking_base<double>>>;

/// Sets a rounding mode, and sets back what was before.
class Rounding {
 public:
  explicit Rounding(int mode) : before_(std::fegetround()) { std::fesetround(mode); }
  ~Rounding() { std::fesetround(before_); }
  Rounding(const Rounding&) = delete;
  Rounding& operator=(const Rounding&) = delete;

 private:
  int before_;
};

/// The mode that Interval needs.
struct RoundUpward : Rounding {
  RoundUpward() : Rounding(FE_UPWARD) {}
};

/// The default mode, for what is not about intervals.
struct RoundToNearest : Rounding {
  RoundToNearest() : Rounding(FE_TONEAREST) {}
};

/// Yes as well where an end is not a number.
inline bool contains_zero(const Interval& x) { return !(x.lower() > 0 || x.upper() < 0); }
inline bool is_disjoint(const Interval& a, const Interval& b) {
  return a.upper() < b.lower() || b.upper() < a.lower();
}
inline bool is_inside(const Interval& a, const Interval& b) {
  return a.lower() >= b.lower() && a.upper() <= b.upper();
}
inline bool is_strictly_inside(const Interval& a, const Interval& b) {
  return a.lower() > b.lower() && a.upper() < b.upper();
}
/// A double near the middle; always inside.
inline double middle(const Interval& x) {
  const double m = x.lower() / 2 + x.upper() / 2;
  return std::fmin(std::fmax(m, x.lower()), x.upper());
}
inline double width_of(const Interval& x) { return x.upper() - x.lower(); }  // rounded up

inline const Interval kPi(3.141592653589793, 3.1415926535897936);  // neighbours of pi

namespace detail {

/// Does x contain an integer? Never no when it does.
inline bool has_integer(const Interval& x) { return std::floor(x.upper()) >= std::ceil(x.lower()); }

/// Smallest and largest of two function values that the library computed, moved outwards.
inline Interval outwards(double a, double b, bool has_maximum, bool has_minimum) {
  const auto beyond = [](double x, double towards) {
    return std::nextafter(std::nextafter(x, towards), towards);
  };
  const double low = has_minimum ? -1 : std::fmax(-1, beyond(std::fmin(a, b), -2));
  const double high = has_maximum ? 1 : std::fmin(1, beyond(std::fmax(a, b), 2));
  return Interval(low, high);
}

template <class F>
std::array<double, 2> in_default_mode(const Interval& x, const F& f) {
  std::fesetround(FE_TONEAREST);
  const volatile double a = f(x.lower()), b = f(x.upper());
  std::fesetround(FE_UPWARD);
  return {a, b};
}

}  // namespace detail

/// Ends beyond 1e5 would cost digits in the library's argument reduction and are no joint angles.
inline bool is_angle(const Interval& x) { return x.lower() >= -1e5 && x.upper() <= 1e5; }

inline Interval sine(const Interval& x) {
  if (!is_angle(x)) return Interval(-1, 1);
  const Interval turns = x / (kPi * 2.0);
  const auto ends = detail::in_default_mode(x, [](double a) { return std::sin(a); });
  return detail::outwards(ends[0], ends[1], detail::has_integer(turns - 0.25),
                          detail::has_integer(turns + 0.25));
}

inline Interval cosine(const Interval& x) {
  if (!is_angle(x)) return Interval(-1, 1);
  const Interval turns = x / (kPi * 2.0);
  const auto ends = detail::in_default_mode(x, [](double a) { return std::cos(a); });
  return detail::outwards(ends[0], ends[1], detail::has_integer(turns),
                          detail::has_integer(turns + 0.5));
}

/// A value and its N partial derivatives over a box (forward mode). Dual<0> is a bare value.
template <int N>
struct Dual {
  Interval v;
  std::array<Interval, N> d;

  Dual() : v(0.0) { d.fill(Interval(0.0)); }
  Dual(double x) : v(x) { d.fill(Interval(0.0)); }  // NOLINT: numbers of the model convert
  explicit Dual(const Interval& x) : v(x) { d.fill(Interval(0.0)); }
  /// The variable number i.
  Dual(const Interval& x, int i) : Dual(x) { d[static_cast<std::size_t>(i)] = Interval(1.0); }

  Dual& operator+=(const Dual& o) {
    v += o.v;
    for (std::size_t i = 0; i < d.size(); ++i) d[i] += o.d[i];
    return *this;
  }
  Dual& operator-=(const Dual& o) {
    v -= o.v;
    for (std::size_t i = 0; i < d.size(); ++i) d[i] -= o.d[i];
    return *this;
  }
  Dual& operator*=(const Dual& o) {
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = d[i] * o.v + v * o.d[i];
    v *= o.v;
    return *this;
  }
  Dual& operator/=(const Dual& o) {
    v /= o.v;
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = (d[i] - v * o.d[i]) / o.v;
    return *this;
  }
  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator*(Dual a, const Dual& b) { return a *= b; }
  friend Dual operator/(Dual a, const Dual& b) { return a /= b; }
  friend Dual operator-(const Dual& a) {
    Dual out;
    out.v = -a.v;
    for (std::size_t i = 0; i < a.d.size(); ++i) out.d[i] = -a.d[i];
    return out;
  }
  /// Nothing is known.
  static Dual unbounded() {
    const double end = std::numeric_limits<double>::infinity();
    Dual out(Interval(-end, end));
    out.d.fill(out.v);
    return out;
  }
  friend double middle(const Dual& x) { return middle(x.v); }
  friend Dual square(const Dual& x) {
    Dual out(boost::numeric::square(x.v));
    for (std::size_t i = 0; i < x.d.size(); ++i) out.d[i] = x.v * x.d[i] * 2.0;
    return out;
  }
  friend Dual inverse_of(const Dual& x) { return contains_zero(x.v) ? unbounded() : Dual(1.0) / x; }
  /// The quotient itself; by the inverse it would be wider.
  friend Dual quotient(const Dual& x, const Dual& y, const Dual&) {
    return contains_zero(y.v) ? unbounded() : x / y;
  }
  friend Dual sin(const Dual& x) { return chain(x, sine(x.v), cosine(x.v)); }
  friend Dual cos(const Dual& x) { return chain(x, cosine(x.v), -sine(x.v)); }

 private:
  static Dual chain(const Dual& x, const Interval& value, const Interval& slope) {
    Dual out(value);
    for (std::size_t i = 0; i < x.d.size(); ++i) out.d[i] = slope * x.d[i];
    return out;
  }
};

/// What Eigen's fixed products ask of a number type, with the costs of reading, adding and
/// multiplying. Nothing here compares or takes square roots.
template <class T, int Read, int Add, int Multiply>
struct ProductTraits : Eigen::GenericNumTraits<T> {
  using Real = T;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = Read,
    AddCost = Add,
    MulCost = Multiply
  };
};

}  // namespace stillbase::proof

template <int N>
struct Eigen::NumTraits<stillbase::proof::Dual<N>>
    : stillbase::proof::ProductTraits<stillbase::proof::Dual<N>, 8, 20, 60> {};
