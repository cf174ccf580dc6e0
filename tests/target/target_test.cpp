#include <catch2/catch.hpp>

#include <Eigen/Dense>

#include <stillbase/core/random.hpp>
#include <stillbase/target/target.hpp>

using namespace stillbase;

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

TargetBody envisat() {
  TargetBody body;
  body.name = "envisat";
  body.mass = 8200;
  body.inertia << 17023.3, 397.1, -2171.4, 397.1, 124825.7, 344.2, -2171.4, 344.2, 129112.2;
  return body;
}

TargetBody with_inertia(const Vector3d& moments) {
  TargetBody body;
  body.mass = 50;
  body.inertia = moments.asDiagonal();
  return body;
}

TargetState tumbling(const Vector3d& rate_in_T) {
  TargetState state;
  state.time = 3;
  state.pose.position = Vector3d(4, -1, 2);
  state.pose.orientation = rotation_exp({0.3, -0.8, 0.5});
  state.linear_velocity = Vector3d(-0.05, 0.01, 0.02);
  state.angular_velocity = state.pose.orientation * rate_in_T;
  return state;
}

Vector3d angular_momentum(const TargetBody& body, const TargetState& s) {
  const Matrix3d R = s.pose.orientation.toRotationMatrix();
  return R * body.inertia * R.transpose() * s.angular_velocity;
}

double energy(const TargetBody& body, const TargetState& s) {
  return 0.5 * s.angular_velocity.dot(angular_momentum(body, s));
}

// Fourth-order central difference of a function of time.
template <class F>
auto rate_of(F f, double t, double h) {
  return ((8 * (f(t + h) - f(t - h)) - (f(t + 2 * h) - f(t - 2 * h))) / (12 * h)).eval();
}

}  // namespace

TEST_CASE("angular momentum and energy of a tumbling body are kept over 1000 s") {
  struct Case {
    TargetBody body;
    Vector3d rate;
  };
  const Case cases[] = {{envisat(), Vector3d(0, 3.53, 0) * kDegree},
                        {envisat(), Vector3d(-0.1489, 3.535, 3.535) * kDegree},
                        {with_inertia({1, 2, 3}), Vector3d(1e-6, 0.5, 1e-6)},  // middle axis
                        {with_inertia({1, 2, 2.9}), Vector3d(0.4, 0.02, 0.3)}};
  for (const Case& c : cases) {
    const TargetState start = tumbling(c.rate);
    const TargetMotion motion(c.body, start, 1000);
    const Vector3d L = angular_momentum(c.body, start);
    const double E = energy(c.body, start);
    for (int i = -50; i <= 50; ++i) {
      const TargetState s = motion.state(start.time + 19.97 * i);
      CHECK((angular_momentum(c.body, s) - L).norm() <= 1e-10 * L.norm());
      CHECK(std::abs(energy(c.body, s) - E) <= 1e-10 * E);
      CHECK(s.pose.orientation.norm() == Approx(1).epsilon(1e-15));
      CHECK((s.pose.position - start.pose.position - 19.97 * i * start.linear_velocity).norm() <=
            1e-12 * 1000);
    }
  }
}

TEST_CASE("rotation about the middle axis flips over, about the outer axes it does not") {
  auto smallest_cosine = [](const Vector3d& rate) {
    const TargetBody body = with_inertia({1, 2, 3});
    const TargetState start = tumbling(rate);
    const TargetMotion motion(body, start, 300);
    double cosine = 1;
    for (double t = 0; t <= 300; t += 0.5) {
      const TargetState s = motion.state(start.time + t);
      const Vector3d w = s.pose.orientation.conjugate() * s.angular_velocity;
      cosine = std::min(cosine, w.normalized().dot(rate.normalized()));
    }
    return cosine;
  };
  CHECK(smallest_cosine({1e-4, 0.5, 0}) < -0.99);
  CHECK(smallest_cosine({0.5, 1e-4, 0}) > 0.9999);
  CHECK(smallest_cosine({1e-4, 0, 0.5}) > 0.9999);
}

TEST_CASE("the prediction solves Euler's equations") {
  Random random(31);
  for (int trial = 0; trial < 10; ++trial) {
    const TargetBody body =
        with_inertia({random.uniform(2, 3), random.uniform(2, 3), random.uniform(3, 4)});
    const TargetState start = tumbling(0.3 * random.unit_vector());
    const TargetMotion motion(body, start, 100);
    const double t = start.time + random.uniform(-90, 90);
    const TargetState s = motion.state(t);
    // In T: I w_dot + w x I w = 0.
    auto rate_in_T = [&](double time) -> Vector3d {
      const TargetState x = motion.state(time);
      return x.pose.orientation.conjugate() * x.angular_velocity;
    };
    const Vector3d w = rate_in_T(t);
    const Vector3d w_rate = rate_of(rate_in_T, t, 1e-2);
    CHECK((body.inertia * w_rate + w.cross(body.inertia * w)).norm() <= 1e-9);
    // The attitude changes at the angular velocity.
    auto turn = [&](double time) -> Vector3d {
      return rotation_log(motion.state(time).pose.orientation * s.pose.orientation.conjugate());
    };
    CHECK((rate_of(turn, t, 1e-2) - s.angular_velocity).norm() <= 1e-9);
  }
}

TEST_CASE("a symmetric top precesses and spins at the closed-form rates") {
  const double A = 2, C = 3.1;
  const TargetBody body = with_inertia({A, A, C});
  const Vector3d w0(0.2, -0.05, 0.3);
  const TargetState start = tumbling(w0);
  const TargetMotion motion(body, start, 1000);
  const Vector3d L = angular_momentum(body, start);
  const double spin = (A - C) / A * w0.z();  // about the symmetry axis, in T
  for (const double dt : {-1000.0, -313.7, -0.1, 0.0, 0.02, 77.7, 1000.0}) {
    const Eigen::Quaterniond q =
        rotation_exp(dt / A * L) * start.pose.orientation * rotation_exp(Vector3d(0, 0, spin * dt));
    const TargetState s = motion.state(start.time + dt);
    CHECK(s.pose.orientation.angularDistance(q) <= 1e-11);
    const Vector3d w = q * (rotation_exp(Vector3d(0, 0, -spin * dt)) * w0);
    CHECK((s.angular_velocity - w).norm() <= 1e-11);
  }
}

TEST_CASE("a sphere rotates at a constant rate and a body at rest stays at rest") {
  const TargetState start = tumbling({0.1, 0.2, -0.3});
  const TargetMotion sphere(with_inertia({3, 3, 3}), start, 500);
  const TargetState later = sphere.state(start.time + 123.4);
  CHECK(later.angular_velocity == start.angular_velocity);
  CHECK(later.pose.orientation.angularDistance(rotation_exp(123.4 * start.angular_velocity) *
                                               start.pose.orientation) <= 1e-13);
  const TargetState still = tumbling({0, 0, 0});
  const TargetState at_rest = TargetMotion(envisat(), still, 500).state(still.time - 499);
  CHECK(at_rest.angular_velocity.isZero(0));
  CHECK(at_rest.pose.orientation.angularDistance(still.pose.orientation) <= 1e-15);
}

TEST_CASE("a point mass does not rotate") {
  TargetBody body;
  body.mass = 100;
  body.is_point_mass = true;
  const TargetState start = tumbling({0, 0, 0.4});
  const TargetMotion motion(body, start, 50);
  const TargetState s = motion.state(start.time + 20);
  CHECK(s.pose.orientation.angularDistance(start.pose.orientation) <= 1e-15);
  const ContactState contact = motion.contact({"front", {0.1, 0, 0}, {1, 0, 0}}, start.time + 20);
  CHECK(contact.velocity == start.linear_velocity);
}

TEST_CASE("a contact point moves at its velocity, the normal with the target") {
  const ContactFeature feature{"corner", {0.3, 0.12, 0.06}, Vector3d(1, 0.2, -0.1).normalized()};
  for (const TargetBody& body : {with_inertia({1, 2, 2.9}), with_inertia({3, 3, 3}), envisat()}) {
    const TargetState start = tumbling({0.2, 0.5, -0.1});
    const TargetMotion motion(body, start, 200);
    for (const double t : {start.time, start.time + 50.3, start.time - 120.1}) {
      const ContactState c = motion.contact(feature, t);
      const TargetState s = motion.state(t);
      CHECK((c.point - s.pose * feature.point).norm() <= 1e-13);
      CHECK((c.r - (c.point - s.pose.position)).norm() <= 1e-12);
      CHECK(c.normal.norm() == Approx(1).epsilon(1e-14));
      auto point = [&](double x) -> Vector3d { return motion.contact(feature, x).point; };
      auto normal = [&](double x) -> Vector3d { return motion.contact(feature, x).normal; };
      CHECK((rate_of(point, t, 1e-2) - c.velocity).norm() <= 1e-8);
      CHECK((rate_of(normal, t, 1e-2) - s.angular_velocity.cross(c.normal)).norm() <= 1e-8);
    }
  }
}

TEST_CASE("the prediction is continuous where it passes from one node to the next") {
  const TargetState start = tumbling({0.2, 0.5, -0.1});
  const TargetMotion motion(with_inertia({1, 2, 2.9}), start, 20);
  for (double dt = -19.99; dt < 19.99; dt += 0.0007) {
    const auto a = motion.state(start.time + dt).pose.orientation;
    const auto b = motion.state(start.time + dt + 1e-9).pose.orientation;
    if (a.angularDistance(b) > 1.5e-9) FAIL("jump at " << dt);
  }
  SUCCEED();
}

TEST_CASE("times outside the horizon and horizons that are no horizon are refused") {
  const TargetState start = tumbling({0.2, 0.5, -0.1});
  const TargetMotion motion(with_inertia({1, 2, 2.9}), start, 20);
  CHECK_NOTHROW(motion.state(start.time + 20));
  CHECK_NOTHROW(motion.state(start.time - 20));
  CHECK_THROWS_AS(motion.state(start.time + 20.001), std::out_of_range);
  CHECK_THROWS_AS(motion.state(std::nan("")), std::out_of_range);
  for (const double horizon : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    CHECK_THROWS_AS(TargetMotion(with_inertia({1, 2, 3}), start, horizon), std::invalid_argument);
  }
}
