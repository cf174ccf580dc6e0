#include <catch2/catch.hpp>

#include <algorithm>

#include <stillbase/core/random.hpp>
#include <stillbase/robot/robot_model.hpp>

#include "approach/time_law.hpp"

using namespace stillbase;

namespace {

bool always(const JointVectord&, const JointVectord&) { return true; }
bool never(const JointVectord&, const JointVectord&) { return false; }

std::vector<JointVectord> zigzag(Random& random, int joints, int count) {
  std::vector<JointVectord> points;
  for (int i = 0; i < count; ++i) {
    JointVectord phi(joints);
    for (Eigen::Index k = 0; k < phi.size(); ++k) phi[k] = random.uniform(-2, 2);
    points.push_back(phi);
  }
  return points;
}

double distance_to_polyline(const JointVectord& phi, const std::vector<JointVectord>& points) {
  double least = kInfinity;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const JointVectord d = points[i + 1] - points[i];
    const double t = std::clamp(d.dot(phi - points[i]) / d.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (phi - points[i] - t * d).norm());
  }
  return least;
}

}  // namespace

TEST_CASE(
    "one joint over a long distance reaches its rate limit and takes about the shortest time") {
  const JointVectord start = JointVectord::Zero(1), end = JointVectord::Constant(1, 10.0);
  const JointVectord rate = JointVectord::Constant(1, 0.5),
                     acceleration = JointVectord::Constant(1, 0.1);
  const JointPath path = time_path({start, end}, {rate, acceleration}, always);
  const double shortest = 10 / 0.5 + 0.5 / 0.1;  // accelerate, cruise, brake
  CHECK(path.times.back() >= shortest);
  CHECK(path.times.back() <= 1.2 * shortest);
  double peak = 0;
  for (std::size_t i = 0; i < path.segments(); ++i) {
    peak = std::max(peak, peak_rates(path, i, path.times[i], path.times[i + 1])[0]);
  }
  CHECK(peak <= 0.5 * (1 + 1e-9));
  CHECK(peak > 0.49);
}

TEST_CASE("zigzags keep rate and acceleration limits on a fine grid, with and without stops") {
  Random random(3);
  for (int i = 0; i < 30; ++i) {
    const std::vector<JointVectord> points = zigzag(random, 4, 2 + random.index(6));
    JointVectord rate(4), acceleration(4);
    for (Eigen::Index k = 0; k < 4; ++k) {
      rate[k] = i % 4 == 0 ? kInfinity : random.uniform(0.1, 2);
      acceleration[k] = random.uniform(0.01, 1);
    }
    for (const bool rounded : {true, false}) {
      const JointPath path = time_path(points, {rate, acceleration}, rounded ? always : never);
      CHECK(path.phi.front() == points.front());
      CHECK(path.phi.back() == points.back());
      CHECK(path.phidot.front().isZero(0));
      CHECK(path.phidot.back().isZero(0));
      double excess = 0, away = 0;
      for (std::size_t s = 0; s < path.segments(); ++s) {
        const double h = path.times[s + 1] - path.times[s];
        for (int part = 0; part <= 10; ++part) {
          const JointMotion m = motion_on_segment(path, s, path.times[s] + h * part / 10);
          excess = std::max(excess, (m.phidot.cwiseAbs().array() / rate.array()).maxCoeff());
          excess =
              std::max(excess, (m.phiddot.cwiseAbs().array() / acceleration.array()).maxCoeff());
          away = std::max(away, distance_to_polyline(m.phi, points));
        }
      }
      CHECK(excess <= 1 + 1e-6);
      CHECK(excess > 0.6);
      // A corner cut by at most 0.5 rad on both sides is missed by at most half of that.
      CHECK(away <= (rounded ? 0.26 : 1e-9));
    }
  }
}

TEST_CASE("rounding corners is faster than stopping at them") {
  Random random(4);
  const JointVectord limit = JointVectord::Constant(3, 0.2);
  double rounded = 0, stopping = 0;
  for (int i = 0; i < 20; ++i) {
    const std::vector<JointVectord> points = zigzag(random, 3, 5);
    rounded += time_path(points, {limit, limit}, always).times.back();
    stopping += time_path(points, {limit, limit}, never).times.back();
  }
  CHECK(rounded < 0.97 * stopping);
}

TEST_CASE("a path that turns straight back has a stop at its tip") {
  const JointVectord a = JointVectord::Zero(2), b = JointVectord::Constant(2, 1.0);
  const JointVectord limit = JointVectord::Constant(2, 0.2);
  const JointPath path = time_path({a, b, 0.5 * b}, {limit, limit}, always);
  bool passes_corner_at_rest = false;
  for (std::size_t i = 0; i < path.times.size(); ++i) {
    if (path.phi[i] == b && path.phidot[i].isZero(0)) passes_corner_at_rest = true;
  }
  CHECK(passes_corner_at_rest);
  CHECK(stretch_for_limits(path, {limit, limit}) <= 1 + 1e-6);
}
