// The enclosed motion of a tumbling body against the integrated one.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include <stillbase/core/random.hpp>
#include <stillbase/core/rotation.hpp>

#include "proof/spin.hpp"

namespace stillbase::proof {
namespace {

struct Tumbling {
  const char* name;
  TargetBody body;
  TargetState estimate;
};

TargetBody body_of(const Matrix3d& inertia) {
  TargetBody body;
  body.mass = 50;
  body.inertia = inertia;
  return body;
}

TargetState estimate_of(const Vector3d& angular_velocity, const Vector3d& attitude) {
  TargetState state;
  state.time = 3;
  state.pose.orientation = rotation_exp(attitude);
  state.angular_velocity = angular_velocity;
  return state;
}

std::vector<Tumbling> examples() {
  const Matrix3d R = rotation_exp(Vector3d(0.4, -0.7, 1.1)).toRotationMatrix();
  const Matrix3d box = Vector3d(3, 4, 5).asDiagonal();
  const Matrix3d disc = Vector3d(4, 4, 7).asDiagonal();
  Matrix3d turned_box = R * box * R.transpose();
  turned_box = ((turned_box + turned_box.transpose()) / 2).eval();
  Matrix3d turned_disc = R * disc * R.transpose();
  turned_disc = ((turned_disc + turned_disc.transpose()) / 2).eval();
  const Vector3d attitude(0.3, 0.2, -0.5);
  return {
      {"at rest", body_of(box), estimate_of(Vector3d::Zero(), attitude)},
      {"about a principal axis", body_of(box), estimate_of({0, 0, 0.1}, Vector3d::Zero())},
      {"a sphere", body_of(4 * Matrix3d::Identity()), estimate_of({0.05, -0.1, 0.08}, attitude)},
      {"with an axis of symmetry", body_of(disc), estimate_of({0.05, -0.1, 0.08}, attitude)},
      {"any", body_of(box), estimate_of({0.05, -0.1, 0.08}, attitude)},
      {"any, in turned axes", body_of(turned_box), estimate_of({0.05, -0.1, 0.08}, attitude)},
      {"about the middle axis, nearly", body_of(box), estimate_of({1e-4, 0.1, 0}, attitude)}};
}

/// How far a number is beyond the ends.
double beyond(const Interval& x, double value) {
  return std::max(x.lower() - value, value - x.upper());
}

template <class Range, class Value>
double farthest_beyond(const Range& range, const Value& value) {
  double out = -kInfinity;
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    out = std::max(out, beyond(range.data()[i].v, value.data()[i]));
  }
  return out;
}

/// The planner's motion.
struct Instant {
  Matrix3d R, R_rate;
  Vector3d omega, omega_rate;
};

Instant instant_of(const Tumbling& example, const TargetMotion& motion, double time) {
  const TargetState state = motion.state(time);
  Instant out;
  out.R = state.pose.orientation.toRotationMatrix();
  out.omega = out.R.transpose() * state.angular_velocity;
  out.R_rate = out.R * skew<double>(out.omega);
  const Matrix3d& I = example.body.inertia;
  out.omega_rate = -I.inverse() * out.omega.cross(Vector3d(I * out.omega));
  return out;
}

double farthest_beyond(const SpinRange& range, const Instant& at) {
  return std::max({farthest_beyond(range.R, at.R), farthest_beyond(range.R_rate, at.R_rate),
                   farthest_beyond(range.omega, at.omega),
                   farthest_beyond(range.omega_rate, at.omega_rate)});
}

template <class Range>
double widest(const Range& range) {
  double out = 0;
  for (Eigen::Index i = 0; i < range.size(); ++i) out = std::max(out, width_of(range.data()[i].v));
  return out;
}

constexpr double kPlannersAccuracy = 1e-9;

}  // namespace

TEST_CASE("the integrated motion of a target is within its enclosure, instants and spans") {
  for (const Tumbling& example : examples()) {
    INFO(example.name);
    const TargetMotion motion(example.body, example.estimate, 200);
    const SpinEnclosure spin(example.body, example.estimate, -20, 120);
    REQUIRE(spin.is_valid());
    Random random(5);
    for (int i = 0; i < 200; ++i) {
      const double t = random.uniform(-20, 120);
      const double half = std::pow(10.0, random.uniform(-6, 1));
      const Instant middle = instant_of(example, motion, t);
      const Instant others[] = {middle, instant_of(example, motion, t - half),
                                instant_of(example, motion, t + 0.37 * half),
                                instant_of(example, motion, t + half)};
      const RoundUpward upward;
      const SpinRange at = spin.over(Interval(t));
      CHECK(widest(at.R) < 1e-8);
      CHECK(farthest_beyond(at, middle) < kPlannersAccuracy);
      const SpinRange over = spin.over(Interval(t - half, t + half));
      for (const Instant& other : others) CHECK(farthest_beyond(over, other) < kPlannersAccuracy);
    }
  }
}

TEST_CASE(
    "Taylor's series of the motion holds it over a span, what it leaves open is of fifth order") {
  for (const Tumbling& example : examples()) {
    INFO(example.name);
    const TargetMotion motion(example.body, example.estimate, 200);
    const SpinEnclosure spin(example.body, example.estimate, -20, 120);
    Random random(9);
    for (int i = 0; i < 100; ++i) {
      const double t = random.uniform(-10, 110);
      const double half = std::pow(10.0, random.uniform(-4, 0.9));
      const double at = t + half * random.uniform(-1, 1);
      const Instant exact = instant_of(example, motion, at);
      const RoundUpward upward;
      const SpinSeries series = spin.series(t, Interval(t - half, t + half));
      const Dual d(Interval(at) - Interval(t));
      SpinRange sum{series.R[0], Matrix3<Dual>(), series.omega[0], Vector3<Dual>()};
      Dual power = d;
      for (std::size_t k = 1; k < SpinSeries::kTerms; ++k, power *= d) {
        sum.R += series.R[k] * power;
        sum.omega += series.omega[k] * power;
      }
      CHECK(farthest_beyond(sum.R, exact.R) < kPlannersAccuracy);
      CHECK(farthest_beyond(sum.omega, exact.omega) < kPlannersAccuracy);
      CHECK(farthest_beyond(series.whole.R, exact.R) < kPlannersAccuracy);
      if (half > 1) continue;
      // |omega| < 0.2: the fifth derivative of R is below 0.2^5 times a small number.
      const double open = std::pow(0.2 * half, 5);
      CHECK(widest(sum.R) < 4 * open + 1e-8);
      CHECK(widest(sum.omega) < 4 * open + 1e-8);
    }
  }
}

TEST_CASE("a narrow span of time gives a narrow enclosure of the motion") {
  for (const Tumbling& example : examples()) {
    INFO(example.name);
    const SpinEnclosure spin(example.body, example.estimate, 0, 60);
    const RoundUpward upward;
    for (const double half : {1.0, 0.1, 1e-3}) {
      const SpinRange over = spin.over(Interval(40 - half, 40 + half));
      // No entry moves faster than |omega| < 0.2; twice that is room for the method.
      CHECK(widest(over.R) <= 2 * 0.2 * 2 * half + 1e-8);
    }
  }
}

TEST_CASE("a target that tumbles for too long is not enclosed, one that spins is") {
  const Matrix3d box = Vector3d(3, 4, 5).asDiagonal();
  const TargetState any = estimate_of({0.5, -1, 0.8}, Vector3d::Zero());
  const TargetState spinning = estimate_of({0, 0, 1}, Vector3d::Zero());
  const Matrix3d disc = Vector3d(7, 4, 4).asDiagonal();
  CHECK_FALSE(SpinEnclosure(body_of(box), any, 0, 2000).is_valid());
  CHECK(SpinEnclosure(body_of(box), spinning, 0, 2000).is_valid());
  CHECK(SpinEnclosure(body_of(disc), any, 0, 2000).is_valid());
}

TEST_CASE("beyond the span that was asked for only what holds at all times is said") {
  const Tumbling example = examples()[6];
  const SpinEnclosure spin(example.body, example.estimate, 0, 10);
  const RoundUpward upward;
  const SpinRange out = spin.over(Interval(9, 11));
  CHECK(widest(out.R) > 2);
  CHECK(widest(out.R) < 2.01);
}

}  // namespace stillbase::proof
