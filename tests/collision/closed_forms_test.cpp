#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/core/rotation.hpp>

#include "collision/closed_forms.hpp"
#include "collision/fcl_shape.hpp"

using namespace stillbase;

namespace {

Pose random_pose(Random& random, double spread) {
  return {Vector3d(random.uniform(-spread, spread), random.uniform(-spread, spread),
                   random.uniform(-spread, spread)),
          rotation_exp(3.0 * random.uniform() * random.unit_vector())};
}

double distance(const Geometry& a, const Pose& pose_a, const Geometry& b, const Pose& pose_b) {
  return fcl_distance(*make_fcl_shape(a), pose_a.orientation.toRotationMatrix(), pose_a.position,
                      *make_fcl_shape(b), pose_b.orientation.toRotationMatrix(), pose_b.position);
}

RoundSegment moved(const Geometry& geometry, const Pose& pose) {
  const auto round = round_segment(geometry);
  REQUIRE(round);
  return {pose * round->a, pose * round->b, round->radius};
}

/// Least distance of the points of a capsule's axis from a convex shape, by ternary search: the
/// distance is convex along the axis.
double capsule_distance(const Capsule& capsule, const Pose& pose, const Geometry& other,
                        const Pose& pose_other) {
  const Pose relative = pose_other.inverse() * pose;
  const auto at = [&](double t) {
    return point_distance(other, relative * Vector3d(0, 0, t * capsule.length / 2));
  };
  double low = -1, high = 1;
  for (int i = 0; i < 200; ++i) {
    const double left = low + (high - low) / 3, right = high - (high - low) / 3;
    if (at(left) < at(right)) {
      high = right;
    } else {
      low = left;
    }
  }
  return at((low + high) / 2) - capsule.radius;
}

}  // namespace

TEST_CASE("distances of spheres and capsules in closed form agree with FCL") {
  Random random(3);
  int apart = 0;
  for (int i = 0; i < 500; ++i) {
    const Geometry a = i % 3 == 0
                           ? Geometry(Sphere{random.uniform(0.05, 0.5)})
                           : Geometry(Capsule{random.uniform(0.05, 0.3), random.uniform(0, 2)});
    const Geometry b = i % 5 == 0
                           ? Geometry(Sphere{random.uniform(0.05, 0.5)})
                           : Geometry(Capsule{random.uniform(0.05, 0.3), random.uniform(0, 2)});
    const Pose pose_a = random_pose(random, 1.5), pose_b = random_pose(random, 1.5);
    const double closed = round_distance(moved(a, pose_a), moved(b, pose_b));
    const double by_fcl = distance(a, pose_a, b, pose_b);
    if (closed > 0) {
      ++apart;
      CHECK(closed == Approx(by_fcl).margin(1e-7));
    } else {
      CHECK(by_fcl == 0);
    }
  }
  CHECK(apart > 100);
  CHECK(apart < 490);
}

TEST_CASE("parallel, crossing and shrunken segments have the right distance") {
  const Vector3d o(0, 0, 0), x(1, 0, 0);
  CHECK(segment_distance(o, x, Vector3d(0, 1, 0), Vector3d(1, 1, 0)) == Approx(1));
  CHECK(segment_distance(o, x, Vector3d(2, 1, 0), Vector3d(5, 1, 0)) == Approx(std::sqrt(2.0)));
  CHECK(segment_distance(o, x, Vector3d(0.5, -1, 0.3), Vector3d(0.5, 1, 0.3)) == Approx(0.3));
  CHECK(segment_distance(o, o, Vector3d(3, 4, 0), Vector3d(3, 4, 0)) == Approx(5));
}

TEST_CASE("FCL's capsule against box agrees with a convex search along the axis") {
  Random random(4);
  int apart = 0;
  for (int i = 0; i < 300; ++i) {
    const Capsule capsule{random.uniform(0.05, 0.2), random.uniform(0.2, 2)};
    const Box box{Vector3d(random.uniform(0.2, 2), random.uniform(0.2, 2), random.uniform(0.2, 2))};
    const Pose pose_a = random_pose(random, 1.5), pose_b = random_pose(random, 1.5);
    const double expected = capsule_distance(capsule, pose_a, box, pose_b);
    const double by_fcl = distance(capsule, pose_a, box, pose_b);
    if (expected > 1e-6) {
      ++apart;
      CHECK(by_fcl == Approx(expected).margin(2e-6));
    } else if (expected < -1e-6) {
      CHECK(by_fcl == 0);
    }
  }
  CHECK(apart > 50);
  CHECK(apart < 290);
}

TEST_CASE("a convex mesh of a box keeps the distances of the box") {
  const Vector3d half(0.5, 0.3, 0.2);
  ConvexMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(Vector3d((i & 1) != 0 ? half.x() : -half.x(),
                                     (i & 2) != 0 ? half.y() : -half.y(),
                                     (i & 4) != 0 ? half.z() : -half.z()));
  }
  mesh.faces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  REQUIRE(is_valid(mesh));
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Pose pose_a = random_pose(random, 1.5), pose_b = random_pose(random, 0.5);
    const Sphere sphere{0.2};
    CHECK(distance(sphere, pose_a, mesh, pose_b) ==
          Approx(distance(sphere, pose_a, Box{2 * half}, pose_b)).margin(2e-6));
  }
  CHECK(point_distance(mesh, Vector3d(1.5, 0, 0)) == Approx(1.0));
  CHECK(point_distance(mesh, Vector3d(0.1, 0.1, 0.1)) == 0);
}

TEST_CASE("every shape lies inside its bounding sphere") {
  Random random(6);
  const std::vector<Geometry> shapes = {Sphere{0.4}, Capsule{0.1, 1.0}, Cylinder{0.3, 0.8},
                                        Box{Vector3d(0.4, 1.0, 0.6)}};
  for (const Geometry& shape : shapes) {
    const BoundingSphere sphere = bounding_sphere(shape);
    for (int i = 0; i < 200; ++i) {
      const Vector3d point = 1.5 * random.uniform() * random.unit_vector();
      if (point_distance(shape, point) == 0) {
        CHECK((point - sphere.centre).norm() <= sphere.radius + 1e-12);
      }
    }
  }
}

TEST_CASE("shapes without a positive finite size are not valid") {
  CHECK(is_valid(Sphere{1}));
  CHECK_FALSE(is_valid(Sphere{0}));
  CHECK_FALSE(is_valid(Capsule{-1, 1}));
  CHECK_FALSE(is_valid(Cylinder{1, std::nan("")}));
  CHECK_FALSE(is_valid(Box{Vector3d(1, 1, kInfinity)}));
  CHECK_FALSE(is_valid(ConvexMesh{}));
}

TEST_CASE("nearest points lie on their shapes, as far apart as the shapes are") {
  const double a = 0.4;
  const ConvexMesh octahedron{
      {{a, 0, 0}, {-a, 0, 0}, {0, a, 0}, {0, -a, 0}, {0, 0, a}, {0, 0, -a}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  const Geometry shapes[] = {Sphere{0.3}, Capsule{0.1, 0.8}, Cylinder{0.2, 0.7},
                             Box{Vector3d(0.3, 0.5, 0.9)}, octahedron};
  Random random(29);
  int apart = 0;
  for (const Geometry& first : shapes) {
    for (const Geometry& second : shapes) {
      for (int i = 0; i < 40; ++i) {
        const Pose at = random_pose(random, 1), other = random_pose(random, 1);
        const auto points = fcl_nearest_points(
            *make_fcl_shape(first), at.orientation.toRotationMatrix(), at.position,
            *make_fcl_shape(second), other.orientation.toRotationMatrix(), other.position);
        const double between = distance(first, at, second, other);
        REQUIRE(points.has_value() == (between > 0));
        if (!points) continue;
        ++apart;
        CHECK((points->front() - points->back()).norm() == Approx(between).margin(1e-12));
        CHECK(point_distance(first, at.inverse() * points->front()) < 1e-12);
        CHECK(point_distance(second, other.inverse() * points->back()) < 1e-12);
      }
    }
  }
  CHECK(apart > 700);
}

TEST_CASE("nearest points of spheres are on the line of their centres") {
  const Pose at{Vector3d(1, 2, 3), Eigen::Quaterniond::Identity()};
  const Pose other{Vector3d(1, 6, 6), rotation_exp(Vector3d(0.3, 1, 0))};
  const auto points = fcl_nearest_points(*make_fcl_shape(Sphere{1}), Matrix3d::Identity(),
                                         at.position, *make_fcl_shape(Sphere{2}),
                                         other.orientation.toRotationMatrix(), other.position);
  REQUIRE(points);
  CHECK((points->front() - Vector3d(1, 2.8, 3.6)).norm() < 1e-12);
  CHECK((points->back() - Vector3d(1, 4.4, 4.8)).norm() < 1e-12);
}
