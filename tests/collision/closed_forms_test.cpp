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
      CHECK(closed == Approx(by_fcl).epsilon(0).margin(1e-7));
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

TEST_CASE("capsule against box agrees with a convex search along the axis") {
  Random random(4);
  int apart = 0;
  for (int i = 0; i < 300; ++i) {
    const Capsule capsule{random.uniform(0.05, 0.2), random.uniform(0.2, 2)};
    const Box box{Vector3d(random.uniform(0.2, 2), random.uniform(0.2, 2), random.uniform(0.2, 2))};
    const Pose pose_a = random_pose(random, 1.5), pose_b = random_pose(random, 1.5);
    const double expected = capsule_distance(capsule, pose_a, box, pose_b);
    const double by_fcl = distance(capsule, pose_a, box, pose_b);
    const double in_closed_form =
        round_box_distance(moved(capsule, pose_a),
                           {box.size / 2, pose_b.orientation.toRotationMatrix(), pose_b.position});
    CHECK(in_closed_form == Approx(expected).epsilon(0).margin(1e-9));
    if (expected > 1e-6) {
      ++apart;
      CHECK(by_fcl == Approx(expected).epsilon(0).margin(2e-6));
    } else if (expected < -1e-6) {
      CHECK(by_fcl == 0);
    }
  }
  CHECK(apart > 50);
  CHECK(apart < 290);
}

TEST_CASE("a segment along a box, across it and of no length has its distance from it") {
  const PlacedBox box{{1, 2, 3}, Matrix3d::Identity(), {10, 0, 0}};
  const auto from_box = [&box](const Vector3d& a, const Vector3d& b) {
    return round_box_distance({box.p + a, box.p + b, 0.5}, box);
  };
  CHECK(from_box({2, -5, 0}, {2, 5, 0}) == Approx(0.5));                 // along a face
  CHECK(from_box({2, -5, 4}, {2, 5, 4}) == Approx(std::sqrt(2) - 0.5));  // along an edge
  CHECK(from_box({1, 2, 3}, {4, 2, 3}) == Approx(-0.5));                 // from a corner
  CHECK(from_box({2, 3, 4}, {2, 3, 4}) == Approx(std::sqrt(3) - 0.5));   // a sphere
  CHECK(from_box({-5, 0.1, 0.2}, {5, 0.1, 0.2}) < 0);                    // through
  CHECK(from_box({0, 0.1, 0.2}, {0.1, 0.1, 0.2}) < 0);                   // inside
  // Past an edge: the foot of the edge on the segment.
  CHECK(from_box({1, 4, 0}, {3, 2, 0}) == Approx(std::sqrt(2) - 0.5));
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
          Approx(distance(sphere, pose_a, Box{2 * half}, pose_b)).epsilon(0).margin(2e-6));
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
        CHECK((points->front() - points->back()).norm() ==
              Approx(between).epsilon(0).margin(1e-12));
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

TEST_CASE("the gap of bounding boxes is no more than the distance of the shapes") {
  Random random(11);
  const auto shape = [&](int kind) -> Geometry {
    const auto size = [&] { return random.uniform(0.05, 0.8); };
    if (kind == 0) return Sphere{size()};
    if (kind == 1) return Capsule{size(), size()};
    if (kind == 2) return Cylinder{size(), size()};
    if (kind == 3) return Box{{size(), size(), size()}};
    ConvexMesh mesh;  // a tetrahedron off its origin
    const Vector3d at(size(), size(), size());
    mesh.vertices = {at, at + size() * Vector3d::UnitX(), at + size() * Vector3d::UnitY(),
                     at + size() * Vector3d::UnitZ()};
    mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return mesh;
  };
  int sharp = 0, apart = 0;
  for (int i = 0; i < 2000; ++i) {
    const Geometry a = shape(i % 5), b = shape((i / 5) % 5);
    const Pose pose_a = random_pose(random, 1.5), pose_b = random_pose(random, 1.5);
    const BoundingBox box_a = bounding_box(a), box_b = bounding_box(b);
    const Matrix3d R_a = pose_a.orientation.toRotationMatrix();
    const Matrix3d R_b = pose_b.orientation.toRotationMatrix();
    const double gap =
        box_gap({box_a.half, R_a, pose_a * box_a.centre}, {box_b.half, R_b, pose_b * box_b.centre});
    const double exact = distance(a, pose_a, b, pose_b);
    CHECK(gap <= exact + 1e-6);
    CHECK(gap == Approx(box_gap({box_b.half, R_b, pose_b * box_b.centre},
                                {box_a.half, R_a, pose_a * box_a.centre}))
                     .epsilon(0)
                     .margin(1e-12));
    apart += exact > 0.1;
    sharp += exact > 0.1 && gap > 0.5 * exact;
  }
  CHECK(apart > 500);
  CHECK(sharp > apart / 2);
}

TEST_CASE("boxes side by side are apart by their gap") {
  const Vector3d half(0.5, 1, 1.5), other(0.2, 0.3, 0.4);
  const Matrix3d R = Matrix3d::Identity();
  CHECK(box_gap({half, R, Vector3d::Zero()}, {other, R, Vector3d(1, 0, 0)}) == Approx(0.3));
  CHECK(box_gap({half, R, Vector3d::Zero()}, {other, R, Vector3d(1, 1.7, 0)}) ==
        Approx(std::hypot(0.3, 0.4)));
  CHECK(box_gap({half, R, Vector3d::Zero()}, {other, R, Vector3d(0.6, 0, 0)}) == 0);
}

namespace {

Vector3d nearest_in(const PlacedBox& box, const Vector3d& point) {
  const Vector3d in_box = box.R.transpose() * (point - box.p);
  return box.p + box.R * in_box.cwiseMax(-box.half).cwiseMin(box.half);
}

/// Distance of two boxes by projections onto the one and the other in turn: from above.
double projected_distance(const PlacedBox& a, const PlacedBox& b) {
  Vector3d in_a = a.p, in_b = b.p;
  for (int i = 0; i < 5000; ++i) {
    in_b = nearest_in(b, in_a);
    in_a = nearest_in(a, in_b);
  }
  return (in_a - in_b).norm();
}

PlacedBox random_box(Random& random, const Matrix3d& R) {
  const auto edge = [&] { return random.uniform(0.01, 0.3); };
  return {{edge(), edge(), edge()}, R, random.uniform(0.1, 1) * random.unit_vector()};
}

}  // namespace

TEST_CASE("the distance of boxes agrees with projections, and FCL's with it") {
  Random random(29);
  int apart = 0;
  for (int trial = 0; trial < 600; ++trial) {
    // Any poses, a common axis, and parallel edges, where GJK stops early.
    const Matrix3d R_a =
        rotation_exp(3.0 * random.uniform() * random.unit_vector()).toRotationMatrix();
    const double angle = trial % 3 == 2 ? 0 : random.uniform(-3, 3);
    const Matrix3d turn = trial % 3 == 0
                              ? rotation_exp(angle * random.unit_vector()).toRotationMatrix()
                              : rotation_exp(angle * Vector3d::UnitX()).toRotationMatrix();
    const PlacedBox a = random_box(random, R_a), b = random_box(random, R_a * turn);
    const double gap = widest_gap(a, b);
    INFO(trial);
    const double found = fcl_distance(*make_fcl_shape(Box{2 * a.half}), a.R, a.p,
                                      *make_fcl_shape(Box{2 * b.half}), b.R, b.p);
    if (gap <= 0) {
      CHECK(found == 0);
      continue;
    }
    ++apart;
    const double distance = separate_box_distance(a, b);
    CHECK(distance >= gap - 1e-12);
    CHECK(distance <= projected_distance(a, b) + 1e-12);
    CHECK(distance >= projected_distance(a, b) - 2e-4);
    CHECK(found == Approx(distance).epsilon(0).margin(2e-6));
  }
  CHECK(apart > 200);
}

TEST_CASE("FCL is not believed where it finds boxes centimetres too far apart") {
  // Two links of an arm that turn about a common axis: 46 mm apart, 64 mm by FCL 0.7.
  PlacedBox elbow{{0.072, 0.016, 0.016},
                  Matrix3d(),
                  {0.26160100743510445, -0.08738444305554594, 0.45962298691108056}};
  elbow.R << 0.8049441652120422, 0.31682846599839126, 0.5016817856213189, -0.26888121822434063,
      0.9484828533680018, -0.16758033104481054, -0.5289307907252925, 0.0, 0.8486649625280385;
  PlacedBox forearm{{0.032, 0.016, 0.016},
                    Matrix3d(),
                    {0.3823426322169107, -0.12771662578919704, 0.3802833683022867}};
  forearm.R << 0.8049441652120422, 0.41359844548707236, 0.425442377745525, -0.26888121822434063,
      0.8934332830577988, -0.35983309910395644, -0.5289307907252925, 0.1752520887614194,
      0.8303727620818716;
  CHECK(separate_box_distance(elbow, forearm) == Approx(0.046).epsilon(0).margin(1e-9));
  CHECK(fcl_distance(*make_fcl_shape(Box{2 * elbow.half}), elbow.R, elbow.p,
                     *make_fcl_shape(Box{2 * forearm.half}), forearm.R,
                     forearm.p) == Approx(0.046).epsilon(0).margin(1e-6));
}
