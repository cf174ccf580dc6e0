// Derivatives by differences against closed forms, also where a function bends within a step.
#include <catch2/catch.hpp>

#include <cmath>

#include "audit/differences.hpp"

namespace stillbase {
namespace {

/// Values at x of functions that bend over a length of `width`.
Eigen::VectorXd functions(double x, double width) {
  return Eigen::Vector3d(std::sin(x + 0.3), std::hypot(x + width, width), 1 / (x + 5 * width));
}

}  // namespace

TEST_CASE("differences of functions that bend within the first step find their derivatives") {
  for (const double width : {1.0, 2e-3, 1e-3}) {
    INFO("bends over " << width);
    const auto values = [&](double x) { return functions(x, width); };
    const Eigen::VectorXd slopes = audit::slopes_at_zero(values, 2e-3);
    CHECK(slopes[0] == Approx(std::cos(0.3)).epsilon(1e-8));
    CHECK(slopes[1] == Approx(std::sqrt(0.5)).epsilon(1e-5));
    CHECK(slopes[2] == Approx(-1 / (25 * width * width)).epsilon(1e-6));
    const Eigen::VectorXd bends = audit::bends_at_zero(values, 1e-2, 1e-6);
    CHECK(bends[0] == Approx(-std::sin(0.3)).epsilon(1e-5));
    CHECK(bends[1] == Approx(std::sqrt(0.125) / width).epsilon(1e-3));
    CHECK(bends[2] == Approx(2 / (125 * std::pow(width, 3))).epsilon(1e-3));
  }
}

TEST_CASE("differences pass over steps at which there is no value") {
  const auto values = [](double x) {
    return Eigen::VectorXd::Constant(1, std::abs(x) > 1e-3 ? INFINITY : std::exp(x));
  };
  CHECK(audit::slopes_at_zero(values, 2e-3)[0] == Approx(1).epsilon(1e-8));
  const auto none = [](double) { return Eigen::VectorXd::Constant(1, INFINITY); };
  CHECK_FALSE(std::isfinite(audit::slopes_at_zero(none, 2e-3)[0]));
}

}  // namespace stillbase
