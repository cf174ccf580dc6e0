#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/core/rotation.hpp>
#include <stillbase/target/target.hpp>

#include "reference/tumbling.hpp"

using namespace stillbase;
using reference::tumble;
using reference::Tumbling;

namespace {

Matrix3d turned_inertia(Random& random, const Vector3d& moments) {
  const Matrix3d R = rotation_exp(random.uniform(0, 3) * random.unit_vector()).toRotationMatrix();
  return R * moments.asDiagonal() * R.transpose();
}

}  // namespace

TEST_CASE("series of a tumbling body keep momentum and energy, forwards and backwards") {
  Random random(41);
  for (int trial = 0; trial < 20; ++trial) {
    const double a = random.uniform(1, 3), b = random.uniform(1, 3);
    const Matrix3d I = turned_inertia(random, {a, b, random.uniform(std::abs(a - b) + 0.1, a + b)});
    const Tumbling start{rotation_exp(random.uniform(0, 3) * random.unit_vector()),
                         random.uniform(0.01, 2) * random.unit_vector()};
    const Vector3d L = start.R_NT * (I * start.omega);
    const double E = start.omega.dot(I * start.omega);
    for (const double dt : {-300.0, -1.3, 0.0, 0.7, 300.0}) {
      const Tumbling then = tumble(I, start, dt).value();
      CHECK((then.R_NT * (I * then.omega) - L).norm() <= 1e-12 * L.norm());
      CHECK(then.omega.dot(I * then.omega) == Approx(E).epsilon(1e-12));
      const Tumbling back = tumble(I, then, -dt).value();
      CHECK(back.R_NT.angularDistance(start.R_NT) <= 1e-10);
    }
  }
}

TEST_CASE("a symmetric top follows its closed form by series") {
  const double A = 2, C = 3.1;
  const Matrix3d I = Vector3d(A, A, C).asDiagonal();
  const Tumbling start{rotation_exp({0.3, -0.8, 0.5}), {0.2, -0.05, 0.3}};
  const Vector3d L = start.R_NT * (I * start.omega);
  const double spin = (A - C) / A * start.omega.z();
  for (const double dt : {-500.0, 3.7, 500.0}) {
    const Tumbling then = tumble(I, start, dt).value();
    const Vector3d turn(0, 0, spin * dt);
    CHECK(then.R_NT.angularDistance(rotation_exp(dt / A * L) * start.R_NT * rotation_exp(turn)) <=
          1e-12);
    CHECK((then.omega - rotation_exp(-turn) * start.omega).norm() <= 1e-12);
  }
}

TEST_CASE("two codes predict the same tumbling") {
  Random random(42);
  for (int trial = 0; trial < 30; ++trial) {
    TargetBody body;
    body.mass = 10;
    body.inertia = turned_inertia(
        random, {random.uniform(2, 3), random.uniform(2.5, 3.5), random.uniform(3, 5)});
    TargetState state;
    state.pose.orientation = rotation_exp(random.uniform(0, 3) * random.unit_vector());
    state.angular_velocity = random.uniform(0.01, 0.5) * random.unit_vector();
    const TargetMotion motion(body, state, 200);
    const Tumbling start{state.pose.orientation,
                         state.pose.orientation.conjugate() * state.angular_velocity};
    for (const double t : {-200.0, -0.3, 17.0, 200.0}) {
      const TargetState stated = motion.state(t);
      const Tumbling own = tumble(body.inertia, start, t).value();
      CHECK(own.R_NT.angularDistance(stated.pose.orientation) <= 1e-11);
      CHECK((own.R_NT * own.omega - stated.angular_velocity).norm() <=
            1e-11 * state.angular_velocity.norm());
    }
  }
}

TEST_CASE("a series that is told to stop says so") {
  std::atomic<bool> interrupted = true;
  StopCondition stop;
  stop.interrupted = &interrupted;
  CHECK_FALSE(tumble(Matrix3d::Identity(), {{1, 0, 0, 0}, {0, 0, 1}}, 1e3, stop));
}
