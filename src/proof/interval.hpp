// Intervals whose ends are rounded outwards.
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

/// Enclosures of the sine and the cosine of every angle of x, rad. [-1, 1] where an end is beyond
/// 1e5: there the argument reduction would cost digits.
Interval sine(const Interval& x);
Interval cosine(const Interval& x);

/// A product of N intervals.
template <int N>
struct Box {
  std::array<Interval, N> side;
  Interval& operator[](int i) { return side[static_cast<std::size_t>(i)]; }
  const Interval& operator[](int i) const { return side[static_cast<std::size_t>(i)]; }
};

/// The widest side.
template <int N>
double width_of(const Box<N>& X) {
  double widest = 0;
  for (const Interval& x : X.side) widest = std::fmax(widest, width_of(x));
  return widest;
}

template <int N>
bool is_inside(const Box<N>& A, const Box<N>& B) {
  for (int i = 0; i < N; ++i) {
    if (!is_inside(A[i], B[i])) return false;
  }
  return true;
}

template <int N>
bool is_disjoint(const Box<N>& A, const Box<N>& B) {
  for (int i = 0; i < N; ++i) {
    if (is_disjoint(A[i], B[i])) return true;
  }
  return false;
}

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
