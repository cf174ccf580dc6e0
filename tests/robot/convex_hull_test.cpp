// Polytopes around points: every point inside, few vertices, the stated distance.
#include <cmath>

#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/robot/physical_checks.hpp>

#include "robot/convex_hull.hpp"

using namespace stillbase;

namespace {

/// By how much a point lies outside of a convex mesh at the most, m.
double outside(const ConvexMesh& mesh, const std::vector<Vector3d>& points) {
  double most = -1e300;
  for (const std::vector<int>& face : mesh.faces) {
    const auto corner = [&](int c) { return mesh.vertices[static_cast<std::size_t>(face[c])]; };
    const Vector3d a = corner(0), b = corner(1), c = corner(2);
    const Vector3d normal = (b - a).cross(c - a).normalized();
    for (const Vector3d& point : points) most = std::max(most, normal.dot(point - a));
  }
  return most;
}

std::vector<Vector3d> sphere_points(int count, double radius) {
  Random random(7);
  std::vector<Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const Vector3d v(random.normal(), random.normal(), random.normal());
    points.push_back(radius * v.normalized());
  }
  return points;
}

}  // namespace

TEST_CASE("the hull of a cube is the cube, whatever lies inside") {
  std::vector<Vector3d> points;
  for (int i = 0; i < 8; ++i) points.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  points.emplace_back(0.5, 0.5, 0.5);
  const EnclosingHull hull = enclosing_hull(points);
  CHECK(hull.mesh.vertices.size() == 8);
  CHECK(hull.mesh.faces.size() == 12);
  CHECK(hull.volume == Approx(1).epsilon(1e-12));
  CHECK(hull.distance == 0);
  CHECK(convex_mesh_fault(hull.mesh).empty());
}

TEST_CASE("many points on a sphere get a polytope outside of them within the stated distance") {
  for (const int count : {500, 21000}) {
    const std::vector<Vector3d> points = sphere_points(count, 0.3);
    for (const int most : {16, 64}) {
      const EnclosingHull hull = enclosing_hull(points, {.max_vertices = most, .distance = 0});
      INFO(count << " points, " << hull.mesh.vertices.size() << " vertices, " << hull.distance);
      CHECK(static_cast<int>(hull.mesh.vertices.size()) <= most);
      CHECK(convex_mesh_fault(hull.mesh).empty());
      CHECK(outside(hull.mesh, points) <= 1e-8);
      double farthest = 0;
      for (const Vector3d& v : hull.mesh.vertices) farthest = std::max(farthest, v.norm() - 0.3);
      CHECK(farthest <= hull.distance + 1e-6);
      CHECK(hull.volume > 4.0 / 3 * 3.14159 * 0.027 * 0.9);
      if (most == 64) CHECK(hull.distance < 0.07 * 0.3);
    }
  }
}

TEST_CASE("the wanted distance is kept with as few vertices as that takes") {
  const std::vector<Vector3d> points = sphere_points(2000, 1);
  const EnclosingHull coarse = enclosing_hull(points, {.max_vertices = 1000, .distance = 0.05});
  const EnclosingHull fine = enclosing_hull(points, {.max_vertices = 1000, .distance = 0.01});
  const double size = std::sqrt(12.0);  // of the box
  CHECK(coarse.distance <= 0.05 * size);
  CHECK(coarse.distance > 0.01 * size);
  CHECK(fine.distance <= 0.01 * size);
  CHECK(coarse.mesh.vertices.size() < fine.mesh.vertices.size());
}

TEST_CASE("flat and thin sets of points get a thickness") {
  std::vector<Vector3d> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const Eigen::Quaterniond tilt = rotation_exp(Vector3d(0.3, -0.4, 0.5));
  for (Vector3d& point : square) point = tilt * point;
  const EnclosingHull flat = enclosing_hull(square);
  CHECK(flat.mesh.vertices.size() >= 8);
  CHECK(outside(flat.mesh, square) <= 0);
  CHECK(enclosing_hull({{0, 0, 0}, {1, 0, 0}}).volume > 0);
  CHECK_THROWS_AS(enclosing_hull({}), std::invalid_argument);
  CHECK_THROWS_AS(enclosing_hull({{1, 2, 3}, {1, 2, 3}}), std::invalid_argument);
}

TEST_CASE("points near to and far from each other get a polytope without fault around them") {
  Random random(11);
  const double scales[] = {1e4, 1, 1e-4, 1e-8, 1e-44};
  for (int i = 0; i < 2000; ++i) {
    std::vector<Vector3d> points;
    const int count = 4 + static_cast<int>(random.uniform(0, 40));
    for (int k = 0; k < count; ++k) {
      Vector3d point;
      for (double& x : point) {
        // As mesh files hold them: most are equal to some other one.
        const double value = static_cast<float>(std::round(random.uniform(-3, 3)) / 3);
        x = value * scales[static_cast<int>(random.uniform(0, 4.999))];
      }
      points.push_back(point);
    }
    const EnclosingHull hull = enclosing_hull(points);
    INFO(i);
    CHECK(convex_mesh_fault(hull.mesh) == "");
    double size = 0;
    for (const Vector3d& point : points) size = std::max(size, point.norm());
    CHECK(outside(hull.mesh, points) <= 1e-6 * size);
    CHECK(std::isfinite(hull.volume));
  }
}
