#include <catch2/catch.hpp>

#include <cmath>

#include <stillbase/core/random.hpp>

#include "proof/dual.hpp"

namespace stillbase::proof {
namespace {

TEST_CASE("sums and quotients are rounded outwards") {
  const RoundUpward upward;
  const Interval third = Interval(1.0) / Interval(3.0);
  CHECK(third.lower() < third.upper());
  CHECK(std::nextafter(third.lower(), 1) == third.upper());
  const Interval one = third * 3.0;
  CHECK((one.lower() < 1 && one.upper() > 1));
  const Interval tenth = Interval(0.1) + Interval(0.2);
  CHECK(tenth.lower() < tenth.upper());
}

TEST_CASE("the rounding mode of before comes back") {
  const int before = std::fegetround();
  {
    const RoundUpward upward;
    CHECK(std::fegetround() == FE_UPWARD);
    (void)sine(Interval(0.5));
    CHECK(std::fegetround() == FE_UPWARD);
  }
  CHECK(std::fegetround() == before);
}

TEST_CASE("sine and cosine enclose their values in long double over every interval") {
  const RoundUpward upward;
  Random random(3);
  for (int trial = 0; trial < 20000; ++trial) {
    const double a = random.uniform(-10, 10);
    const double b = a + (trial % 2 == 0 ? random.uniform(0, 8) : random.uniform(0, 1e-9));
    const Interval X(a, b), s = sine(X), c = cosine(X);
    for (int i = 0; i <= 4; ++i) {
      const double x = std::fmin(b, std::fmax(a, a + (b - a) * i / 4));
      std::fesetround(FE_TONEAREST);
      const long double exact_s = std::sin(static_cast<long double>(x));
      const long double exact_c = std::cos(static_cast<long double>(x));
      std::fesetround(FE_UPWARD);
      if (!(s.lower() <= exact_s && exact_s <= s.upper())) FAIL("sine of " << x);
      if (!(c.lower() <= exact_c && exact_c <= c.upper())) FAIL("cosine of " << x);
    }
    if (b - a < 1e-8 && s.upper() - s.lower() > 2e-8) FAIL("sine too wide at " << a);
  }
}

TEST_CASE("an interval over an extremum has it as its end, one beside it has not") {
  const RoundUpward upward;
  CHECK(sine(Interval(1.5, 1.6)).upper() == 1);
  CHECK(sine(Interval(1.5, 1.57)).upper() < 1);
  CHECK(sine(Interval(-1.6, -1.5)).lower() == -1);
  CHECK(cosine(Interval(-0.1, 0.1)).upper() == 1);
  CHECK(cosine(Interval(3.1, 3.2)).lower() == -1);
  CHECK(cosine(Interval(0.1, 3.1)).lower() > -1);
  CHECK(sine(Interval(-100, 100)).lower() == -1);
  CHECK(sine(Interval(1e6, 1e6)).lower() == -1);
}

TEST_CASE("a dual number carries the derivative of products, quotients and angles") {
  const RoundUpward upward;
  const Dual x(Interval(0.7), 0, 2), y(Interval(1.3), 1, 2);
  const Dual f = sin(x) * cos(y) / (x + Dual(2.0) * y) - y;
  const double g = std::sin(0.7) * std::cos(1.3), q = 0.7 + 2.6;
  CHECK(middle(f.v) == Approx(g / q - 1.3).epsilon(1e-14));
  CHECK(middle(f.d[0]) == Approx(std::cos(0.7) * std::cos(1.3) / q - g / (q * q)).epsilon(1e-14));
  CHECK(middle(f.d[1]) ==
        Approx(-std::sin(0.7) * std::sin(1.3) / q - 2 * g / (q * q) - 1).epsilon(1e-14));
  CHECK(width_of(f.d[1]) < 1e-14);
}

}  // namespace
}  // namespace stillbase::proof
