#include <catch2/catch.hpp>

#include <cmath>

#include "proof/enclose.hpp"

namespace stillbase::proof {
namespace {

/// A system as a function.
template <int N, class F>
class Written final : public System<N> {
 public:
  explicit Written(F f, double tolerance = 0) : f_(f) { tolerance_.fill(tolerance); }
  void evaluate(const std::array<Dual, N>& x, std::array<Dual, N>& f) const override { f_(x, f); }
  std::array<double, N> tolerance() const override { return tolerance_; }

 private:
  F f_;
  std::array<double, N> tolerance_;
};

/// Zeros of a parabola and its axis, at +-half on the axis; a tolerance of 1e-9.
Enclosure<2> zeros_of_parabola(double half) {
  const auto parabola = [half](const auto& x, auto& f) {
    f[0] = x[1] - x[0] * x[0] + half * half;
    f[1] = x[1] + 0.0 * x[0];
  };
  Box<2> domain;
  for (Interval& side : domain.side) side = Interval(-1, 1.3);
  return enclose_zeros<2>(Written<2, decltype(parabola)>(parabola, 1e-9), domain, {});
}

template <int N, class F>
Enclosure<N> zeros_of(F f, const Box<N>& domain, std::array<bool, N> periodic = {},
                      const EncloseOptions& options = {}) {
  return enclose_zeros<N>(Written<N, F>(f), domain, periodic, options);
}

template <int N>
bool holds(const Enclosure<N>& found, const std::array<double, N>& point) {
  const auto in = [&](const Box<N>& box) {
    for (int i = 0; i < N; ++i) {
      if (!(box[i].lower() <= point[i] && point[i] <= box[i].upper())) return false;
    }
    return true;
  };
  for (const Zero<N>& zero : found.zeros) {
    if (in(zero.tight)) return true;
  }
  for (const Box<N>& box : found.undecided) {
    if (in(box)) return true;
  }
  return false;
}

template <int N>
Box<N> cube(double low, double high) {
  Box<N> box;
  for (int i = 0; i < N; ++i) box[i] = Interval(low, high);
  return box;
}

TEST_CASE("all zeros of a polynomial are enclosed, each in a box of its own") {
  const RoundUpward upward;
  // (x - 1)(x - 2)(x + 0.5)
  const auto found =
      zeros_of<1>([](const auto& x, auto& f) { f[0] = (x[0] - 1.0) * (x[0] - 2.0) * (x[0] + 0.5); },
                  cube<1>(-3, 4));
  REQUIRE(found.complete());
  REQUIRE(found.zeros.size() == 3);
  for (const double zero : {1.0, 2.0, -0.5}) CHECK(holds<1>(found, {zero}));
  for (const auto& zero : found.zeros) CHECK(width_of(zero.tight) < 1e-14);
}

TEST_CASE("a function without a zero is proven to have none") {
  const RoundUpward upward;
  const auto found = zeros_of<2>(
      [](const auto& x, auto& f) {
        f[0] = x[0] * x[0] + x[1] * x[1] - 1.0;
        f[1] = x[0] + x[1] - 1.5;  // passes the circle at 0.06
      },
      cube<2>(-2, 2));
  CHECK(found.complete());
  CHECK(found.zeros.empty());
}

TEST_CASE("zeros on the corners and edges of the first divisions are found once") {
  const RoundUpward upward;
  const auto found = zeros_of<2>(
      [](const auto& x, auto& f) {
        f[0] = x[0] * x[0] - x[0];
        f[1] = x[1] * x[1] - x[1];
      },
      cube<2>(-1, 1.0588235294117647));
  CHECK(found.complete());
  CHECK(found.zeros.size() == 4);
}

TEST_CASE("two zeros 1e-6 apart are told apart") {
  const RoundUpward upward;
  const auto found = zeros_of<2>(
      [](const auto& x, auto& f) {
        f[0] = x[1] - x[0] * x[0] + 0.25e-12;  // parabola below the axis by (5e-7)^2
        f[1] = x[1] + 0.0 * x[0];
      },
      cube<2>(-1, 1.3));
  CHECK(found.complete());
  REQUIRE(found.zeros.size() == 2);
  CHECK(holds<2>(found, {5e-7, 0}));
  CHECK(holds<2>(found, {-5e-7, 0}));
}

TEST_CASE("a double zero is never lost and never called proven") {
  const RoundUpward upward;
  const auto found = zeros_of<2>(
      [](const auto& x, auto& f) {
        f[0] = x[1] - (x[0] - 0.3) * (x[0] - 0.3);
        f[1] = x[1] * (x[0] + 0.7);
      },
      cube<2>(-1, 1.3));
  CHECK_FALSE(found.complete());
  CHECK(found.undecided.size() == 1);
  CHECK(holds<2>(found, {0.3, 0}));
  CHECK(found.zeros.size() == 1);  // (-0.7, 1)
  CHECK(holds<2>(found, {-0.7, 1.0}));
  CHECK(width_of(found.undecided[0]) < 1e-3);
}

TEST_CASE("zeros that a tolerance does not tell apart are one undecided place") {
  const RoundUpward upward;
  for (const double half : {0.0, 1e-9, 1e-6, 2e-5}) {
    CAPTURE(half);
    const auto found = zeros_of_parabola(half);
    CHECK(found.zeros.empty());
    REQUIRE(found.undecided.size() == 1);
    // All points at which both values are within 1e-9.
    const double extent = std::sqrt(half * half + 2e-9);
    for (const double x : {-extent, -half, 0.0, half, extent}) {
      CHECK(found.undecided[0][0].lower() <= 0.999 * x + 1e-12);
      CHECK(found.undecided[0][0].upper() >= 0.999 * x - 1e-12);
    }
    CHECK(width_of(found.undecided[0]) < 3 * extent);
    CHECK(found.boxes < 2000);
  }
}

TEST_CASE("a function that misses zero by less than its tolerance has an undecided place") {
  const RoundUpward upward;
  const auto square = [](const auto& x, auto& f) { f[0] = x[0] * x[0] + 0.9e-9; };
  Box<1> domain;
  domain[0] = Interval(-1, 1.3);
  CHECK(enclose_zeros<1>(Written<1, decltype(square)>(square), domain, {}).complete());
  const auto found = enclose_zeros<1>(Written<1, decltype(square)>(square, 1e-9), domain, {});
  CHECK(found.zeros.empty());
  CHECK(found.undecided.size() == 1);
}

TEST_CASE("zeros that a tolerance tells apart come with all points within it") {
  const RoundUpward upward;
  for (const double half : {1e-3, 1e-2, 0.1}) {
    CAPTURE(half);
    const auto found = zeros_of_parabola(half);
    REQUIRE(found.complete());
    REQUIRE(found.zeros.size() == 2);
    for (const Zero<2>& zero : found.zeros) {
      const double at = middle(zero.tight[0]);
      CHECK(std::abs(std::abs(at) - half) < 1e-12);
      CHECK(width_of(zero.tight) < 1e-12);
      // |x^2 - half^2| <= 2e-9 in all
      CHECK(zero.reach[0].lower() <= at - 0.9e-9 / half);
      CHECK(zero.reach[0].upper() >= at + 0.9e-9 / half);
      CHECK(width_of(zero.reach) < 3e-9 / half);
    }
  }
}

TEST_CASE("the same angle at both ends of its range of 360 deg is one zero") {
  const RoundUpward upward;
  const auto found = zeros_of<2>(
      [](const auto& x, auto& f) {
        f[0] = sin(x[0]);  // 0 and pi
        f[1] = sin(x[1]) - 0.5;
      },
      cube<2>(-kPi.upper(), kPi.upper()), {true, true});
  CHECK(found.complete());
  CHECK(found.zeros.size() == 4);
}

TEST_CASE("a zero outside a limit is not reported, one on it or just beside it is undecided") {
  const RoundUpward upward;
  const auto line = [](const auto& x, auto& f) { f[0] = x[0] - 1.0; };
  CHECK(zeros_of<1>(line, cube<1>(-1, 0.999999)).zeros.empty());
  CHECK(zeros_of<1>(line, cube<1>(-1, 0.999999)).complete());
  // What a solver with a tolerance takes for inside.
  const auto beside = zeros_of<1>(line, cube<1>(-1, 0.99999999));
  CHECK(beside.zeros.empty());
  CHECK(beside.undecided.size() == 1);
  const auto at_limit =
      zeros_of<1>([](const auto& x, auto& f) { f[0] = x[0] * 3.0 - 1.0; }, cube<1>(-1, 1.0 / 3));
  CHECK(holds<1>(at_limit, {1.0 / 3}));
}

TEST_CASE("three spheres intersect in two points") {
  const RoundUpward upward;
  const auto found = zeros_of<3>(
      [](const auto& x, auto& f) {
        const auto r = x[0] * x[0] + x[1] * x[1];
        f[0] = r + x[2] * x[2] - 3.0;
        f[1] = r - x[0] * 2.0 + x[2] * x[2] - 1.0;
        f[2] = r - x[1] * 2.0 + x[2] * x[2] - 1.0;
      },
      cube<3>(-4, 4.1));
  CHECK(found.complete());
  CHECK(found.zeros.size() == 2);
  CHECK(holds<3>(found, {1, 1, 1}));
  CHECK(holds<3>(found, {1, 1, -1}));
}

TEST_CASE("a limit of boxes leaves the other boxes undecided and loses nothing") {
  const RoundUpward upward;
  const auto found = zeros_of<2>(
      [](const auto& x, auto& f) {
        f[0] = sin(x[0] * 3.0) * cos(x[1]);
        f[1] = sin(x[1] * 3.0) + 0.3 * x[0];
      },
      cube<2>(-3, 3.1), {}, {.max_boxes = 20});
  CHECK(found.limit_reached);
  CHECK_FALSE(found.complete());
  CHECK(found.boxes <= 20);
  CHECK(holds<2>(found, {0, 0}));
}

}  // namespace
}  // namespace stillbase::proof
