// The distances of the verification against closed forms, searches and FCL.
#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/core/rotation.hpp>

#include "collision/closed_forms.hpp"
#include "collision/fcl_shape.hpp"
#include "verification/convex_distance.hpp"

using namespace stillbase;
using namespace stillbase::verification;

namespace {

Pose random_pose(Random& random, double spread) {
  return {Vector3d(random.uniform(-spread, spread), random.uniform(-spread, spread),
                   random.uniform(-spread, spread)),
          rotation_exp(3.0 * random.uniform() * random.unit_vector())};
}

PlacedShape placed(const Geometry& geometry, const Pose& pose) {
  return {&geometry, pose.orientation.toRotationMatrix(), pose.position};
}

DistanceBounds bounds(const Geometry& a, const Pose& pose_a, const Geometry& b,
                      const Pose& pose_b) {
  return convex_distance(placed(a, pose_a), placed(b, pose_b));
}

double by_fcl(const Geometry& a, const Pose& pose_a, const Geometry& b, const Pose& pose_b) {
  return fcl_distance(*make_fcl_shape(a), pose_a.orientation.toRotationMatrix(), pose_a.position,
                      *make_fcl_shape(b), pose_b.orientation.toRotationMatrix(), pose_b.position);
}

/// Least value of a convex function of one variable on [-1, 1], by thirds.
template <class Function>
double least(const Function& f) {
  double low = -1, high = 1;
  for (int i = 0; i < 45; ++i) {
    const double left = low + (high - low) / 3, right = high - (high - low) / 3;
    (f(left) < f(right) ? high : low) = f(left) < f(right) ? right : left;
  }
  return f((low + high) / 2);
}

/// The edges of box a against the edges and faces of box b, and the reverse: where two boxes are
/// apart, one of the nearest points lies on an edge.
double by_edges(const Box& a, const Pose& pose_a, const Box& b, const Pose& pose_b) {
  double smallest = kInfinity;
  const auto look = [&](const Box& edges, const Pose& from, const Box& body, const Pose& to) {
    const Pose relative = to.inverse() * from;
    for (int axis = 0; axis < 3; ++axis) {
      for (int corner = 0; corner < 4; ++corner) {
        Vector3d point = edges.size / 2;
        if ((corner & 1) != 0) point[(axis + 1) % 3] *= -1;
        if ((corner & 2) != 0) point[(axis + 2) % 3] *= -1;
        smallest = std::min(smallest, least([&](double t) {
                              Vector3d at = point;
                              at[axis] *= t;
                              return point_distance(body, relative * at);
                            }));
      }
    }
  };
  look(a, pose_a, b, pose_b);
  look(b, pose_b, a, pose_a);
  return smallest;
}

ConvexMesh mesh_of(const Box& box) {
  ConvexMesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Vector3d sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    mesh.vertices.push_back(sign.cwiseProduct(box.size / 2));
  }
  mesh.faces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  return mesh;
}

Geometry random_shape(Random& random) {
  const auto size = [&] { return random.uniform(0.05, 0.8); };
  switch (random.index(5)) {
    case 0:
      return Sphere{size()};
    case 1:
      return Capsule{size() / 3, size()};
    case 2:
      return Cylinder{size() / 2, size()};
    case 3:
      return Box{Vector3d(size(), size(), size())};
    default:
      return mesh_of(Box{Vector3d(size(), size(), size())});
  }
}

}  // namespace

TEST_CASE("distances of round shapes are those in closed form, also where they overlap a little") {
  Random random(11);
  int apart = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto draw = [&]() -> Geometry {
      if (random.index(3) == 0) return Sphere{random.uniform(0.05, 0.5)};
      return Capsule{random.uniform(0.05, 0.3), random.uniform(0, 2)};
    };
    const Geometry a = draw(), b = draw();
    const Pose pose_a = random_pose(random, 1.5), pose_b = random_pose(random, 1.5);
    const auto round = [](const Geometry& geometry, const Pose& pose) {
      const RoundSegment own = *round_segment(geometry);
      return RoundSegment{pose * own.a, pose * own.b, own.radius};
    };
    const double expected = round_distance(round(a, pose_a), round(b, pose_b));
    const DistanceBounds found = bounds(a, pose_a, b, pose_b);
    CHECK(found.lower <= expected + 1e-12);
    CHECK(found.upper >= expected - 1e-12);
    CHECK(found.upper - found.lower <= 1e-9);
    if (expected > 0) ++apart;
  }
  CHECK(apart > 200);
  CHECK(apart < 990);
}

TEST_CASE("distances of boxes, flat ones too, are those of their edges") {
  Random random(12);
  int apart = 0;
  for (int i = 0; i < 150; ++i) {
    const auto draw = [&] {
      Box box{Vector3d(random.uniform(0.2, 2), random.uniform(0.2, 2), random.uniform(0.2, 2))};
      if (i % 2 == 0) box.size[random.index(3)] = i % 4 == 0 ? 1e-3 : 0.02;
      return box;
    };
    const Box a = draw(), b = draw();
    const Pose pose_a = random_pose(random, 1.2), pose_b = random_pose(random, 1.2);
    const double expected = by_edges(a, pose_a, b, pose_b);
    if (expected < 1e-6) continue;  // an edge goes through the other box
    ++apart;
    const DistanceBounds found = bounds(a, pose_a, b, pose_b);
    CHECK(found.upper - found.lower <= 1e-9);
    CHECK(found.upper == Approx(expected).epsilon(0).margin(1e-7));
    const DistanceBounds as_meshes = bounds(mesh_of(a), pose_a, mesh_of(b), pose_b);
    CHECK(as_meshes.upper == Approx(found.upper).epsilon(0).margin(1e-9));
  }
  CHECK(apart > 40);
}

TEST_CASE("cylinders have the distances of their rims, caps and sides") {
  const Cylinder disc{0.5, 0.2};
  const auto at = [&](const Geometry& other, const Vector3d& position) {
    return bounds(disc, Pose{}, other, Pose{position, Eigen::Quaterniond::Identity()}).upper;
  };
  CHECK(at(Sphere{0.1}, {0.2, 0.1, 1.2}) == Approx(1));
  CHECK(at(Sphere{0.1}, {0, 1.6, 0.05}) == Approx(1));
  CHECK(at(Sphere{0.1}, {0.8 * 0.6, 0.8 * 0.8, 0.5}) == Approx(0.4));  // 0.3, 0.4 off the rim
  CHECK(at(Cylinder{0.5, 0.2}, {0.9, 0.9, 0}) == Approx(0.9 * std::sqrt(2.0) - 1));
  CHECK(at(Cylinder{0.5, 0.2}, {0.3, 0, 0.7}) == Approx(0.5));
}

TEST_CASE("shapes that overlap have a negative distance") {
  const Pose here, near{{0.1, 0, 0}, rotation_exp({0.2, 0.1, 0.3})};
  for (const Geometry& a : {Geometry(Box{{1, 1, 1e-3}}), Geometry(Cylinder{0.5, 0.2}),
                            Geometry(Sphere{0.3}), Geometry(mesh_of(Box{{0.5, 0.4, 0.3}}))}) {
    for (const Geometry& b : {Geometry(Box{{0.2, 0.3, 0.4}}), Geometry(Capsule{0.1, 1})}) {
      CHECK(bounds(a, here, b, near).upper < 0);
      CHECK(bounds(a, here, b, here).upper < 0);
    }
  }
}

TEST_CASE("bounds hold where the search ends early, and agree with FCL where it goes on") {
  Random random(13);
  int apart = 0;
  for (int i = 0; i < 1500; ++i) {
    const Geometry a = random_shape(random), b = random_shape(random);
    const Pose pose_a = random_pose(random, 1), pose_b = random_pose(random, 1);
    const DistanceBounds found = bounds(a, pose_a, b, pose_b);
    const double other = by_fcl(a, pose_a, b, pose_b);
    INFO(i << ": shapes " << a.index() << " and " << b.index());
    if (found.upper <= 1e-6) {
      CHECK(other <= 5e-4);
      continue;
    }
    ++apart;
    CHECK(found.upper - found.lower <= 1e-9);
    CHECK(found.upper == Approx(other).epsilon(0).margin(5e-4));
    const DistanceBounds early =
        convex_distance(placed(a, pose_a), placed(b, pose_b), 0.3 * found.upper);
    CHECK(early.lower >= 0.3 * found.upper - 1e-12);
    CHECK(early.lower <= found.upper + 1e-12);
    CHECK(early.upper >= found.lower - 1e-12);
  }
  CHECK(apart > 300);
  CHECK(apart < 1450);
}
