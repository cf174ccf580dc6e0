#include "proof/interval.hpp"

#include <array>

namespace stillbase::proof {
namespace {

/// Does x contain an integer? Never no when it does.
bool has_integer(const Interval& x) { return std::floor(x.upper()) >= std::ceil(x.lower()); }

/// Whether the argument reduction of sin and cos keeps its digits.
bool is_angle(const Interval& x) { return x.lower() >= -1e5 && x.upper() <= 1e5; }

/// Values of a library function at both ends, computed in the default rounding mode.
template <class F>
std::array<double, 2> values_at_ends(const Interval& x, const F& f) {
  std::fesetround(FE_TONEAREST);
  const volatile double a = f(x.lower()), b = f(x.upper());
  std::fesetround(FE_UPWARD);
  return {a, b};
}

/// Range of a sine or cosine from its values at the ends of the argument, moved outwards by two
/// units in the last place.
Interval range_of_wave(const std::array<double, 2>& ends, bool has_maximum, bool has_minimum) {
  const auto beyond = [](double x, double towards) {
    return std::nextafter(std::nextafter(x, towards), towards);
  };
  const double low = has_minimum ? -1 : std::fmax(-1, beyond(std::fmin(ends[0], ends[1]), -2));
  const double high = has_maximum ? 1 : std::fmin(1, beyond(std::fmax(ends[0], ends[1]), 2));
  return Interval(low, high);
}

}  // namespace

Interval sine(const Interval& x) {
  if (!is_angle(x)) return Interval(-1, 1);
  const Interval revolutions = x / (kPi * 2.0);
  return range_of_wave(values_at_ends(x, [](double a) { return std::sin(a); }),
                       has_integer(revolutions - 0.25), has_integer(revolutions + 0.25));
}

Interval cosine(const Interval& x) {
  if (!is_angle(x)) return Interval(-1, 1);
  const Interval revolutions = x / (kPi * 2.0);
  return range_of_wave(values_at_ends(x, [](double a) { return std::cos(a); }),
                       has_integer(revolutions), has_integer(revolutions + 0.5));
}

}  // namespace stillbase::proof
