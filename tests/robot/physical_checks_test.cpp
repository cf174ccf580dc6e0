#include <limits>

#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/robot/physical_checks.hpp>

#include "support/random_robot.hpp"

using namespace stillbase;

namespace {

Matrix3d diagonal(double a, double b, double c) { return Vector3d(a, b, c).asDiagonal(); }

bool mentions(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("tensors of real bodies pass in any axes") {
  Random random(1);
  for (int i = 0; i < 200; ++i) CHECK(inertia_fault(random_inertia(random, 10, 1)).empty());
  const Matrix3d R = random_rotation(random);
  // A flat plate, where one moment is the sum of the others, also as written with six digits.
  CHECK(inertia_fault(R * diagonal(1, 2, 3) * R.transpose()).empty());
  CHECK(inertia_fault(diagonal(0.0833333, 0.0833333, 0.166667)).empty());
}

TEST_CASE("tensors that are not positive definite are refused with their principal moments") {
  Random random(2);
  const Matrix3d R = random_rotation(random);
  const Matrix3d I = R * diagonal(0.003, 0.002, -0.0005) * R.transpose();
  const std::string fault = inertia_fault(0.5 * (I + I.transpose()));
  CHECK(mentions(fault, "not positive definite"));
  CHECK(mentions(fault, "-0.0005, 0.002, 0.003"));
  CHECK(mentions(inertia_fault(Matrix3d::Zero()), "not positive definite"));
  CHECK(mentions(inertia_fault(diagonal(0, 1, 1)), "not positive definite"));
}

TEST_CASE("tensors that break the triangle inequality are refused, also when it is hidden") {
  CHECK(mentions(inertia_fault(diagonal(0.25, 0.25, 1.69)), "triangle inequality"));
  CHECK(mentions(inertia_fault(diagonal(1, 1, 2.001)), "triangle inequality"));
  // The diagonal alone looks fine: 1.5, 1.5, 1; the principal moments are 0.6, 1, 2.4.
  Matrix3d I = diagonal(1.5, 1.5, 1);
  I(0, 1) = I(1, 0) = 0.9;
  CHECK(mentions(inertia_fault(I), "0.6, 1, 2.4"));
}

TEST_CASE("tensors that are not finite or not symmetric are refused") {
  CHECK_FALSE(inertia_fault(diagonal(1, 1, std::numeric_limits<double>::quiet_NaN())).empty());
  CHECK_FALSE(inertia_fault(diagonal(1, 1, std::numeric_limits<double>::infinity())).empty());
  Matrix3d I = diagonal(1, 1, 1);
  I(0, 1) = 0.1;
  CHECK(mentions(inertia_fault(I), "symmetric"));
}

TEST_CASE("a mass must be finite and greater than zero") {
  CHECK(mass_fault(1e-9).empty());
  for (const double mass : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity()}) {
    CHECK_FALSE(mass_fault(mass).empty());
  }
}
