#include <catch2/catch.hpp>

#include <atomic>
#include <cmath>
#include <vector>

#include "proof/bound.hpp"

namespace stillbase::proof {
namespace {

template <int N, class F>
class Written final : public Program<N> {
 public:
  explicit Written(F f) : f_(f) {}
  void evaluate(const std::array<Form<N>, N>& x, std::vector<Form<N>>& equations,
                std::vector<Fraction<N>>& values) const override {
    f_(x, equations, values);
  }

 private:
  F f_;
};

template <int N, class F>
Bound bound_of(F f, const Box<N>& domain, const BoundOptions& options) {
  const RoundUpward upward;
  return bound_below<N>(Written<N, F>(f), {domain}, options);
}

template <int N>
Box<N> cube(double low, double high) {
  Box<N> box;
  for (int i = 0; i < N; ++i) box[i] = Interval(low, high);
  return box;
}

/// Two valleys, one deeper than the other by 4e-3 only.
constexpr auto kTwoValleys = [](const auto& x, auto&, auto& values) {
  const auto u = square(x[0]) - 1.0;
  values.push_back({square(u) + square(x[1] - x[0] * 0.5) + x[0] * 2e-3 + 1.0});
};
double two_valleys(double x, double y) {
  return std::pow(x * x - 1, 2) + std::pow(y - 0.5 * x, 2) + 2e-3 * x + 1;
}

}  // namespace

TEST_CASE("of two nearly equal minima the lower one is the bound") {
  double least = 10;
  for (int i = 0; i <= 400; ++i) {
    for (int j = 0; j <= 250; ++j) {
      least = std::min(least, two_valleys(-2 + 0.01 * i, -1 + 0.01 * j));
    }
  }
  const Bound bound =
      bound_of<2>(kTwoValleys, cube<2>(-2, 2), {.cut = 1.01, .goal = least * (1 - 1e-5)});
  CAPTURE(bound.boxes);
  CHECK(bound.lower <= least);
  CHECK(bound.lower >= least * (1 - 1e-5));
  CHECK_FALSE(bound.limit_reached);
  CHECK_FALSE(bound.nothing_below_cut);
  // With the value of the other valley for the best known one the bound is not fooled.
  const double other = two_valleys(1, 0.5);
  const auto wrong = bound_of<2>(kTwoValleys, cube<2>(-2, 2), {.cut = other, .goal = other});
  CHECK(wrong.lower <= least);
}

TEST_CASE("where nothing reaches the best known value that is said") {
  const Bound bound = bound_of<2>(kTwoValleys, cube<2>(-2, 2), {.cut = 0.9, .goal = 0.89});
  CHECK((bound.nothing_below_cut || bound.lower >= 0.89));
  const auto to_the_end = bound_of<2>(kTwoValleys, cube<2>(-2, 2), {.cut = 0.9});
  CHECK(to_the_end.nothing_below_cut);
  CHECK(to_the_end.lower == 0.9);
}

TEST_CASE("a minimum on a curve is bounded to the curve, not to the box") {
  // x + 2 y on the unit circle: at least -sqrt 5.
  const auto circle = [](const auto& x, auto& equations, auto& values) {
    equations.push_back(square(x[0]) + square(x[1]) - 1.0);
    values.push_back({x[0] + x[1] * 2.0});
  };
  const double least = -std::sqrt(5.0);
  const Bound bound = bound_of<2>(circle, cube<2>(-3, 3.1), {.cut = 0, .goal = least - 1e-6});
  CAPTURE(bound.boxes);
  CHECK(bound.lower <= least);
  CHECK(bound.lower >= least - 1e-6);
  CHECK(bound.boxes < 400);
}

TEST_CASE("two surfaces of a space leave a curve, on which the bound is sharp") {
  const auto curve = [](const auto& x, auto& equations, auto& values) {
    equations.push_back(square(x[0]) + square(x[1]) + square(x[2]) - 1.0);
    equations.push_back(x[0] + x[1] + x[2]);
    values.push_back({sin(x[0]) + x[1] * 0.3 + 2.0});
  };
  double least = 10;
  const Eigen::Vector3d u = Eigen::Vector3d(1, -1, 0).normalized();
  const Eigen::Vector3d v = Eigen::Vector3d(1, 1, -2).normalized();
  for (int i = 0; i < 100000; ++i) {
    const Eigen::Vector3d x = std::cos(2e-5 * M_PI * i) * u + std::sin(2e-5 * M_PI * i) * v;
    least = std::min(least, std::sin(x[0]) + 0.3 * x[1] + 2.0);
  }
  const Bound bound =
      bound_of<3>(curve, cube<3>(-2, 2.1), {.cut = 1.5, .goal = least * (1 - 1e-5)});
  CAPTURE(bound.boxes);
  CHECK(bound.lower <= least);
  CHECK(bound.lower >= least * (1 - 1e-5));
  CHECK(bound.boxes < 2000);
}

TEST_CASE("the least maximum of several functions is bounded by their mixtures") {
  // max of three paraboloids about the corners of a triangle: least in its middle.
  const auto corners = [](const auto& x, auto&, auto& values) {
    for (const double angle : {0.3, 2.4, 4.5}) {
      values.push_back({square(x[0] - std::cos(angle)) + square(x[1] - std::sin(angle))});
    }
  };
  const Bound bound = bound_of<2>(corners, cube<2>(-2, 2.1), {.cut = 1.01, .goal = 1 - 1e-6});
  CAPTURE(bound.boxes);
  CHECK(bound.lower <= 1 + 1e-12);
  CHECK(bound.lower >= 1 - 1e-6);
}

TEST_CASE("of a largest value over all angles the angles that matter are asked for on a curve") {
  // max over theta of x cos theta + y sin theta + 0.3 x + 2 on the unit circle: 3 + 0.3 x.
  std::vector<double> angles = {0};
  const auto of_angles = [&angles](const auto& x, auto& equations, auto& values) {
    equations.push_back(square(x[0]) + square(x[1]) - 1.0);
    for (const double angle : angles) {
      values.push_back({x[0] * (std::cos(angle) + 0.3) + x[1] * std::sin(angle) + 2.0});
    }
  };
  BoundOptions options{.cut = 2.7 * (1 + 1e-6), .goal = 2.7 * (1 - 1e-3), .max_boxes = 4000};
  options.add_values = [&angles](const Eigen::VectorXd& x, double least) {
    const double largest = x.norm() + 0.3 * x[0] + 2;
    if (largest > least) angles.push_back(std::atan2(x[1], x[0]));
    return largest;
  };
  const Bound bound = bound_of<2>(of_angles, cube<2>(-3, 3.1), options);
  CAPTURE(bound.boxes, angles.size());
  CHECK(bound.lower <= 2.7 * (1 + 1e-12));
  CHECK(bound.lower >= 2.7 * (1 - 1e-3));
  CHECK_FALSE(bound.limit_reached);
  CHECK(angles.size() < 200);
}

TEST_CASE("a quotient is bounded without a division") {
  // (x^2 + y^2 + 1) / (2 + sin x)^2: bounded where numerator and denominator are.
  const auto quotient = [](const auto& x, auto&, auto& values) {
    values.push_back({square(x[0]) + square(x[1]) + 1.0, square(sin(x[0]) + 2.0), 1.0});
  };
  double least = 10;
  for (int i = 0; i <= 40000; ++i) {
    const double x = -2 + 1e-4 * i;
    least = std::min(least, (x * x + 1) / std::pow(2 + std::sin(x), 2));
  }
  const Bound bound =
      bound_of<2>(quotient, cube<2>(-2, 2.1), {.cut = 1.001 * least, .goal = least * (1 - 1e-6)});
  CAPTURE(bound.boxes);
  CHECK(bound.lower <= least);
  CHECK(bound.lower >= least * (1 - 1e-6));
  // Cut short it holds as well, with the denominator as large as it gets.
  const auto early = bound_of<2>(quotient, cube<2>(-2, 2.1),
                                 {.cut = 1.001 * least, .goal = least, .max_boxes = 3});
  CHECK(early.limit_reached);
  CHECK(early.lower <= least);
}

TEST_CASE("limits and interrupts leave a bound that holds, and the same request the same answer") {
  const auto cut_short =
      bound_of<2>(kTwoValleys, cube<2>(-2, 2), {.cut = 1.01, .goal = 1, .max_boxes = 40});
  CHECK(cut_short.limit_reached);
  CHECK(cut_short.lower <= two_valleys(-1, -0.5));
  CHECK(std::isfinite(cut_short.lower));
  std::atomic<bool> interrupted = true;
  const auto stopped = bound_of<2>(kTwoValleys, cube<2>(-2, 2),
                                   {.cut = 1.01, .goal = 1, .stop = {.interrupted = &interrupted}});
  CHECK(stopped.limit_reached);
  CHECK(stopped.lower <= cut_short.lower);
  const auto again =
      bound_of<2>(kTwoValleys, cube<2>(-2, 2), {.cut = 1.01, .goal = 1, .max_boxes = 40});
  CHECK(again.lower == cut_short.lower);
  CHECK(again.boxes == cut_short.boxes);
}

TEST_CASE("equations without a solution leave nothing") {
  const auto apart = [](const auto& x, auto& equations, auto& values) {
    equations.push_back(square(x[0]) + square(x[1]) - 1.0);
    equations.push_back(x[0] + x[1] - 1.5);
    values.push_back({x[0]});
  };
  const Bound bound = bound_of<2>(apart, cube<2>(-2, 2), {.cut = 5, .goal = 4});
  CHECK(bound.nothing_below_cut);
}

TEST_CASE("a point that is better than the best known one ends the search and is handed over") {
  BoundOptions options{.cut = two_valleys(1, 0.5), .goal = two_valleys(1, 0.5) * (1 - 1e-4)};
  int asked = 0;
  options.value_at = [&](const Eigen::VectorXd& x) {
    ++asked;
    return two_valleys(x[0], x[1]);
  };
  const Bound found = bound_of<2>(kTwoValleys, cube<2>(-2, 2), options);
  REQUIRE(found.suspects.size() == 1);
  CHECK(two_valleys(found.suspects[0][0], found.suspects[0][1]) < options.goal);
  CHECK(asked > 0);
  CHECK_FALSE(found.nothing_below_cut);
  // Whoever knows better may say so: then the bound is the functions' own.
  options.value_at = [](const Eigen::VectorXd&) { return 10.0; };
  const Bound own = bound_of<2>(kTwoValleys, cube<2>(-2, 2), options);
  CHECK_FALSE(own.limit_reached);
  CHECK(own.suspects.empty());
  CHECK(own.lower <= two_valleys(-1, -0.5));
  CHECK(own.lower >= two_valleys(-1, -0.5) * (1 - 3e-4));
  // Of a search that was cut short the least known boxes are handed over.
  options.max_boxes = 5;
  const Bound early = bound_of<2>(kTwoValleys, cube<2>(-2, 2), options);
  CHECK(early.limit_reached);
  CHECK(early.suspects.size() > 1);
}

}  // namespace stillbase::proof
