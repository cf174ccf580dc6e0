#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <catch2/catch.hpp>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/random.hpp>

#include "core/sines.hpp"

namespace stillbase {
namespace {

/// All that run on this processor.
std::vector<const SinesKernel*> kernels() {
  std::vector<const SinesKernel*> out;
  for (const SinesKernel* kernel :
       {sines_kernel_avx512(), sines_kernel_avx2(), sines_kernel_any_machine()}) {
    if (kernel != nullptr && kernel->runs_here()) out.push_back(kernel);
  }
  return out;
}

/// Angles as of joints, small ones, and next to multiples of pi/2, where the reduction must be
/// sharp.
std::vector<double> angles() {
  Random random(21);
  std::vector<double> out;
  for (int i = 0; i < 40000; ++i) out.push_back(random.uniform(-100, 100));
  for (int i = 0; i < 400; ++i) out.push_back(random.uniform(-1e-8, 1e-8));
  for (int i = 0; i < 400; ++i) out.push_back(random.uniform(-1e6, 1e6));
  for (int k = -63; k <= 63; ++k) {
    out.push_back(k * kPi / 2);
    for (int i = 0; i < 7; ++i) out.push_back(k * kPi / 2 + random.uniform(-1, 1) * 1e-12);
  }
  REQUIRE(out.size() % kSinesAtOnce == 0);
  return out;
}

double ulps_off(double found, long double exact) {
  const double at = std::abs(static_cast<double>(exact));
  const double ulp = std::nextafter(at, 2) - at;
  return static_cast<double>(std::abs(found - exact)) / ulp;
}

}  // namespace

TEST_CASE("sines and cosines are within 2 ulp, with the same digits from every kernel") {
  const std::vector<double> x = angles();
  const int n = static_cast<int>(x.size());
  std::vector<double> sine(x.size()), cosine(x.size());
  sines_and_cosines(x.data(), n, sine.data(), cosine.data());
  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const long double wide = x[i];
    worst =
        std::max({worst, ulps_off(sine[i], std::sin(wide)), ulps_off(cosine[i], std::cos(wide))});
  }
  CHECK(worst < 2);
  for (const SinesKernel* kernel : kernels()) {
    std::vector<double> s(x.size()), c(x.size());
    kernel->run(x.data(), n, s.data(), c.data());
    CHECK(s == sine);
    CHECK(c == cosine);
  }
}

TEST_CASE("a count that fills no register leaves what is behind the next multiple of it") {
  for (const SinesKernel* kernel : kernels()) {
    for (int n = 0; n <= 2 * kSinesAtOnce; ++n) {
      std::vector<double> x(3 * kSinesAtOnce, 0), s(x.size(), 7), c(x.size(), 7);
      for (int i = 0; i < n; ++i) x[static_cast<std::size_t>(i)] = 0.3 * i;
      kernel->run(x.data(), n, s.data(), c.data());
      for (int i = 0; i < n; ++i) {
        CHECK(s[static_cast<std::size_t>(i)] == Approx(std::sin(0.3 * i)).epsilon(0).margin(1e-15));
        CHECK(c[static_cast<std::size_t>(i)] == Approx(std::cos(0.3 * i)).epsilon(0).margin(1e-15));
      }
      const int end = (n + kSinesAtOnce - 1) / kSinesAtOnce * kSinesAtOnce;
      for (auto i = static_cast<std::size_t>(end); i < x.size(); ++i) {
        CHECK(s[i] == 7);
        CHECK(c[i] == 7);
      }
    }
  }
}

TEST_CASE("sines and cosines of large angles, infinity and NaN are the library's") {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> x = {1e7, 0, -1e300, 1, kInf, kNaN, -1e6, 5};
  for (const SinesKernel* kernel : kernels()) {
    std::vector<double> s(x.size()), c(x.size());
    kernel->run(x.data(), static_cast<int>(x.size()), s.data(), c.data());
    for (const std::size_t i : {0u, 2u, 6u}) {
      CHECK(s[i] == std::sin(x[i]));
      CHECK(c[i] == std::cos(x[i]));
    }
    CHECK((std::isnan(s[4]) && std::isnan(c[4]) && std::isnan(s[5]) && std::isnan(c[5])));
    CHECK(s[7] == Approx(std::sin(5.0)));
    CHECK(c[1] == 1);
  }
}

}  // namespace stillbase
