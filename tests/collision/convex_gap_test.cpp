// Distances of convex shapes where GJK stops early.
#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>

#include "collision/convex_gap.hpp"
#include "collision/fcl_shape.hpp"
#include "robot/convex_hull.hpp"
#include "verification/convex_distance.hpp"

namespace stillbase {
namespace {

/// A tube with flat sides along x, as meshes of arms are.
ConvexMesh tube(double from, double to) {
  constexpr int kSides = 14;
  std::vector<Vector3d> vertices;
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2 * kPi * k / kSides;
    for (const double x : {from, to}) {
      vertices.emplace_back(x, 0.03 * std::cos(angle), 0.03 * std::sin(angle));
    }
  }
  return enclosing_hull(vertices).mesh;
}

struct Placement {
  Matrix3d R;
  Vector3d p;
};

double by_fcl(const Geometry& a, const Placement& at_a, const Geometry& b, const Placement& at_b) {
  return fcl_distance(*make_fcl_shape(a), at_a.R, at_a.p, *make_fcl_shape(b), at_b.R, at_b.p);
}

}  // namespace

TEST_CASE("GJK is not believed where it finds meshes of a wrist centimetres too far apart") {
  const Geometry forearm = tube(0.02, 0.1), gripper = tube(0, 0.04);
  Random random(5);
  int compared = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    // A wrist that is nearly straight, 0.1 m along the forearm; the gripper 0.07 m beyond, with a
    // roll of its own.
    const Placement arm{rotation_exp(2 * random.unit_vector()).toRotationMatrix(),
                        random.unit_vector()};
    const double flex = random.uniform(-0.3, 0.3), roll = random.uniform(-3, 3);
    const Matrix3d wrist = arm.R * Eigen::AngleAxisd(flex, Vector3d::UnitY()).toRotationMatrix();
    const Placement hand{wrist * Eigen::AngleAxisd(roll, Vector3d::UnitX()).toRotationMatrix(),
                         arm.p + arm.R * Vector3d(0.1, 0, 0) + wrist * Vector3d(0.0697, 0, 0)};
    const auto expected =
        verification::convex_distance({&forearm, arm.R, arm.p}, {&gripper, hand.R, hand.p}, 1);
    if (expected.upper - expected.lower > 1e-7) continue;
    ++compared;
    CHECK(by_fcl(forearm, arm, gripper, hand) == Approx(expected.upper).epsilon(0).margin(2e-6));
  }
  CHECK(compared > 1500);
}

TEST_CASE("a supporting plane never proves more than the distance, and the nearest one all of it") {
  const std::vector<Geometry> shapes = {Sphere{0.1}, Capsule{0.05, 0.3}, Cylinder{0.1, 0.2},
                                        Box{Vector3d(0.1, 0.2, 0.3)}, tube(-0.1, 0.1)};
  Random random(8);
  int apart = 0, overlapping = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Geometry& a = shapes[static_cast<std::size_t>(trial) % shapes.size()];
    const Geometry& b = shapes[static_cast<std::size_t>(trial) / shapes.size() % shapes.size()];
    const Placement at_a{rotation_exp(2 * random.unit_vector()).toRotationMatrix(),
                         random.uniform(0, 0.6) * random.unit_vector()};
    const Placement at_b{rotation_exp(2 * random.unit_vector()).toRotationMatrix(),
                         Vector3d::Zero()};
    const PlacedGeometry one{a, at_a.R, at_a.p}, other{b, at_b.R, at_b.p};
    const auto expected =
        verification::convex_distance({&a, at_a.R, at_a.p}, {&b, at_b.R, at_b.p}, 1);
    const double found = convex_gap(one, other, at_a.p.normalized());
    if (expected.upper <= 0) {
      ++overlapping;
      CHECK(found <= 1e-6);
      continue;
    }
    ++apart;
    CHECK(found == Approx(expected.upper).epsilon(0).margin(1e-5));
    CHECK(gap_along(one, other, random.unit_vector()) <= expected.upper + 1e-12);
  }
  CHECK(apart > 500);
  CHECK(overlapping > 100);
}

}  // namespace stillbase
