#include <cmath>

#include <catch2/catch.hpp>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/core/rotation.hpp>

using namespace stillbase;

TEST_CASE("skew(r) x is the cross product r x x") {
  Random random(1);
  for (int i = 0; i < 10; ++i) {
    const Vector3d r = random.unit_vector(), x = random.unit_vector();
    CHECK((skew<double>(r) * x - r.cross(x)).norm() < 1e-15);
  }
}

TEST_CASE("rotation_exp agrees with the angle-axis matrix") {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Vector3d axis = random.unit_vector();
    const double angle = random.uniform(0, 7);
    const Matrix3d expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    CHECK((rotation_exp(angle * axis).toRotationMatrix() - expected).norm() < 1e-14);
  }
}

TEST_CASE("rotation_log undoes rotation_exp from tiny angles up to pi") {
  Random random(3);
  const double angles[] = {0,    1e-300, 1e-160, 1e-13, 1e-12,      1e-9,       1e-8,
                           1e-6, 1e-3,   0.3,    1.0,   kPi - 1e-3, kPi - 1e-9, kPi - 1e-14};
  for (const double angle : angles) {
    for (int i = 0; i < 20; ++i) {
      const Vector3d a = angle * random.unit_vector();
      INFO("angle " << angle);
      // Relative to the angle: a log that flushed tiny angles to zero would fail.
      CHECK((rotation_log(rotation_exp(a)) - a).norm() <= 1e-14 * angle);
    }
  }
}

TEST_CASE("rotation_log takes q and -q as the same rotation and never exceeds pi") {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Vector3d a = random.uniform(0, 2 * kPi) * random.unit_vector();
    const Eigen::Quaterniond q = rotation_exp(a);
    const Eigen::Quaterniond minus_q(-q.w(), -q.x(), -q.y(), -q.z());
    CHECK((rotation_log(q) - rotation_log(minus_q)).norm() < 1e-14);
    CHECK(rotation_log(q).norm() <= kPi + 1e-15);
    CHECK((rotation_exp(rotation_log(q)).toRotationMatrix() - q.toRotationMatrix()).norm() < 1e-14);
  }
}

TEST_CASE("the right Jacobian agrees with central differences") {
  Random random(5);
  for (const double angle : {0.0, 1e-9, 1e-4, 0.1, 0.2999, 0.3001, 1.0, 2.5, 3.1}) {
    const Vector3d a = angle * random.unit_vector();
    const Matrix3d J = rotation_right_jacobian(a);
    const double h = 1e-5;
    for (int k = 0; k < 3; ++k) {
      const Vector3d da = h * Vector3d::Unit(k);
      const Eigen::Quaterniond q = rotation_exp(a).conjugate();
      const Vector3d column =
          (rotation_log(q * rotation_exp(a + da)) - rotation_log(q * rotation_exp(a - da))) /
          (2 * h);
      INFO("angle " << angle << ", column " << k);
      CHECK((J.col(k) - column).norm() < 1e-9);
    }
  }
}

TEST_CASE("the right Jacobian leaves its own axis alone and is transposed for -a") {
  const Vector3d a(0.4, -1.1, 0.7);
  const Matrix3d J = rotation_right_jacobian(a);
  CHECK((J * a - a).norm() < 1e-15);
  CHECK((rotation_right_jacobian(-a) - J.transpose()).norm() < 1e-15);
}

TEST_CASE("roll, pitch and yaw rotate about fixed axes in this order") {
  const Vector3d x = Vector3d::UnitX();
  CHECK((rotation_rpy(0, 0, kPi / 2) * x - Vector3d::UnitY()).norm() < 1e-15);
  CHECK((rotation_rpy(0, kPi / 2, 0) * x + Vector3d::UnitZ()).norm() < 1e-15);
  CHECK((rotation_rpy(kPi / 2, 0, kPi / 2) * Vector3d::UnitY() - Vector3d::UnitZ()).norm() < 1e-15);
}

TEST_CASE("poses compose, invert and map points") {
  const Pose T_AB{{1, 2, 3}, rotation_rpy(0.3, -0.2, 1.0)};
  const Pose T_BC{{-1, 0.5, 2}, rotation_rpy(-1.3, 0.7, 0.1)};
  const Vector3d point(0.1, -0.4, 0.9);
  CHECK((T_AB * T_BC * point - T_AB * (T_BC * point)).norm() < 1e-14);
  CHECK((T_AB.inverse() * (T_AB * point) - point).norm() < 1e-14);
}

TEST_CASE("wrapped angles lie above -pi and at most at pi") {
  CHECK(wrap_angle(kPi) == kPi);
  CHECK(wrap_angle(-kPi) == kPi);
  CHECK(wrap_angle(0.5) == 0.5);
  CHECK(wrap_angle(2 * kPi + 0.25) == Approx(0.25).epsilon(0).margin(1e-15));
  CHECK(wrap_angle(-3.5 * kPi) == Approx(0.5 * kPi).epsilon(0).margin(1e-14));
}
