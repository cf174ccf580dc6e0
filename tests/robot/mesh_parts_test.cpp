// Concave meshes as convex parts: everything inside, much smaller than the hull, the same each
// time.
#include <algorithm>
#include <cmath>
#include <functional>

#include <catch2/catch.hpp>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/core/rotation.hpp>
#include <stillbase/robot/physical_checks.hpp>

#include "robot/mesh_parts.hpp"

using namespace stillbase;

namespace {

void add_box(Mesh& mesh, const Vector3d& low, const Vector3d& high) {
  const int faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                            {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const int first = static_cast<int>(mesh.vertices.size());
  for (int i = 0; i < 8; ++i) {
    const Vector3d corner(i & 1, (i >> 1) & 1, (i >> 2) & 1);
    mesh.vertices.push_back(low + (high - low).cwiseProduct(corner));
  }
  for (const auto& f : faces) mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
}

/// A prism over a polygon in the xy plane, counter-clockwise. @param fan corner that sees all
/// others
Mesh prism(const std::vector<std::pair<double, double>>& outline, int fan, double height) {
  Mesh mesh;
  const int n = static_cast<int>(outline.size());
  for (const double z : {0.0, height}) {
    for (const auto& [x, y] : outline) mesh.vertices.emplace_back(x, y, z);
  }
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    mesh.triangles.push_back({i, j, n + j});
    mesh.triangles.push_back({i, n + j, n + i});
    if (i == fan || j == fan) continue;
    mesh.triangles.push_back({fan, j, i});
    mesh.triangles.push_back({n + fan, n + i, n + j});
  }
  return mesh;
}

Mesh angle_bracket() {  // an L of one piece
  return prism({{0, 0}, {1, 0}, {1, 0.2}, {0.2, 0.2}, {0.2, 1}, {0, 1}}, 3, 0.5);
}

Mesh channel() {  // a U of three plates
  Mesh mesh;
  add_box(mesh, {0, 0, 0}, {1, 0.5, 0.1});
  add_box(mesh, {0, 0, 0.1}, {0.1, 0.5, 1});
  add_box(mesh, {0.9, 0, 0.1}, {1, 0.5, 1});
  return mesh;
}

Mesh torus(int around, int across) {
  constexpr double kRadius = 1, kTube = 0.2;
  Mesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double a = 2 * kPi * i / around, b = 2 * kPi * j / across;
      const double r = kRadius + kTube * std::cos(b);
      mesh.vertices.emplace_back(r * std::cos(a), r * std::sin(a), kTube * std::sin(b));
    }
  }
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const int k = (i + 1) % around, l = (j + 1) % across;
      mesh.triangles.push_back({i * across + j, k * across + j, k * across + l});
      mesh.triangles.push_back({i * across + j, k * across + l, i * across + l});
    }
  }
  return mesh;
}

/// A palm with two fingers that end in hooks.
Mesh gripper() {
  Mesh mesh;
  add_box(mesh, {-0.1, -0.3, 0}, {0.1, 0.3, 0.1});
  for (const double side : {-1.0, 1.0}) {
    const auto box = [&](double from, double to, double low, double high) {
      add_box(mesh, {-0.05, std::min(side * from, side * to), low},
              {0.05, std::max(side * from, side * to), high});
    };
    box(0.3, 0.24, 0.1, 0.5);
    box(0.24, 0.18, 0.4, 0.5);
  }
  return mesh;
}

/// Three bars that cross in their middle.
Mesh star() {
  Mesh mesh;
  add_box(mesh, {-1, -0.1, -0.1}, {1, 0.1, 0.1});
  add_box(mesh, {-0.1, -1, -0.1}, {0.1, 1, 0.1});
  add_box(mesh, {-0.1, -0.1, -1}, {0.1, 0.1, 1});
  return mesh;
}

Mesh turned(Mesh mesh) {
  const Eigen::Quaterniond q = rotation_exp(Vector3d(0.3, 0.5, -0.8));
  for (Vector3d& vertex : mesh.vertices) vertex = q * vertex + Vector3d(0.4, -2, 0.1);
  return mesh;
}

Vector3d corner(const Mesh& mesh, const std::array<int, 3>& triangle, std::size_t c) {
  return mesh.vertices[static_cast<std::size_t>(triangle[c])];
}

/// How far a point lies outside of a convex mesh, m; negative inside.
double outside(const ConvexMesh& mesh, const Vector3d& point) {
  double most = -1e300;
  for (const std::vector<int>& face : mesh.faces) {
    const auto at = [&](std::size_t c) { return mesh.vertices[static_cast<std::size_t>(face[c])]; };
    const Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    most = std::max(most, normal.dot(point - at(0)));
  }
  return most;
}

double outside(const std::vector<EnclosingHull>& parts, const Vector3d& point) {
  double least = 1e300;
  for (const EnclosingHull& part : parts) least = std::min(least, outside(part.mesh, point));
  return least;
}

double total_volume(const std::vector<EnclosingHull>& parts) {
  double volume = 0;
  for (const EnclosingHull& part : parts) volume += part.volume;
  return volume;
}

/// Checks that parts are convex, within their numbers and hold every triangle.
void check_parts(const Mesh& mesh, const std::vector<EnclosingHull>& parts) {
  CHECK(static_cast<int>(parts.size()) <= PartsOptions{}.max_parts);
  for (const EnclosingHull& part : parts) {
    CHECK(convex_mesh_fault(part.mesh).empty());
    CHECK(part.mesh.vertices.size() <= 32);
    CHECK(part.distance < 0.1);
  }
  Random random(3);
  double most = -1e300;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    for (int i = 0; i < 20; ++i) {
      double u = random.uniform(0, 1), v = random.uniform(0, 1);
      if (i < 3) u = i == 1, v = i == 2;  // the corners
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vector3d a = corner(mesh, triangle, 0);
      const Vector3d point =
          a + u * (corner(mesh, triangle, 1) - a) + v * (corner(mesh, triangle, 2) - a);
      most = std::max(most, outside(parts, point));
    }
  }
  CHECK(most <= 1e-8);
}

struct Shape {
  const char* name;
  Mesh mesh;
  double volume;  ///< of the mesh, m^3
  double most;    ///< volume of the parts relative to the mesh's
  int most_parts;
};

std::vector<Shape> shapes() {
  return {{"L", angle_bracket(), 0.18, 1.001, 2},
          {"U", channel(), 0.14, 1.001, 3},
          {"torus", torus(48, 16), 2 * kPi * kPi * 0.04, 1.4, 12},
          {"gripper", gripper(), 0.012 + 2 * (0.0024 + 0.0006), 1.01, 5},
          {"L, turned", turned(angle_bracket()), 0.18, 1.02, 2},
          {"U, turned", turned(channel()), 0.14, 1.02, 3},
          {"gripper, turned", turned(gripper()), 0.018, 1.1, 7}};
}

}  // namespace

TEST_CASE("the parts of a concave mesh hold its triangles and are much smaller than its hull") {
  for (const Shape& shape : shapes()) {
    INFO(shape.name);
    const std::vector<EnclosingHull> parts = convex_parts(shape.mesh);
    INFO(parts.size() << " parts of " << total_volume(parts) << " m^3, mesh " << shape.volume
                      << ", hull " << enclosing_hull(shape.mesh.vertices).volume);
    CHECK(parts.size() >= 2);
    CHECK(static_cast<int>(parts.size()) <= shape.most_parts);
    CHECK(total_volume(parts) <= shape.most * shape.volume);
    CHECK(total_volume(parts) < 0.6 * enclosing_hull(shape.mesh.vertices).volume);
    check_parts(shape.mesh, parts);
  }
}

TEST_CASE("parts hold what a closed mesh encloses, also where three cuts meet inside of it") {
  const auto is_in_l = [](const Vector3d& p) { return p.x() < 0.2 || p.y() < 0.2; };
  const auto is_in_torus = [](const Vector3d& p) {
    return std::pow(std::hypot(p.x(), p.y()) - 1, 2) + p.z() * p.z() < 0.199 * 0.199 * 0.9;
  };
  const auto is_in_star = [](const Vector3d& p) {
    return (p.cwiseAbs().array() < 0.1).count() >= 2;
  };
  struct Solid {
    Mesh mesh;
    Vector3d low, high;
    std::function<bool(const Vector3d&)> contains;
  };
  const std::vector<Solid> solids{{angle_bracket(), {0, 0, 0}, {1, 1, 0.5}, is_in_l},
                                  {torus(48, 16), {-1.2, -1.2, -0.2}, {1.2, 1.2, 0.2}, is_in_torus},
                                  {star(), {-1, -1, -1}, {1, 1, 1}, is_in_star}};
  for (const Solid& solid : solids) {
    const std::vector<EnclosingHull> parts = convex_parts(solid.mesh);
    CHECK(parts.size() >= 2);
    Random random(5);
    int inside = 0;
    double most = -1e300;
    while (inside < 2000) {
      Vector3d point;
      for (int k = 0; k < 3; ++k) point[k] = random.uniform(solid.low[k], solid.high[k]);
      if (!solid.contains(point)) continue;
      ++inside;
      most = std::max(most, outside(parts, point));
    }
    CHECK(most <= 1e-8);
  }
}

TEST_CASE("parts of many triangles hold all of them") {
  const Mesh mesh = torus(150, 50);
  const std::vector<EnclosingHull> parts = convex_parts(mesh);
  CHECK(total_volume(parts) < 0.65 * enclosing_hull(mesh.vertices).volume);
  check_parts(mesh, parts);
}

TEST_CASE("the same mesh gives the same parts, bit for bit") {
  for (const Shape& shape : shapes()) {
    const auto once = convex_parts(shape.mesh), again = convex_parts(shape.mesh);
    REQUIRE(once.size() == again.size());
    for (std::size_t i = 0; i < once.size(); ++i) {
      CHECK(once[i].mesh.vertices == again[i].mesh.vertices);
      CHECK(once[i].mesh.faces == again[i].mesh.faces);
    }
  }
}

TEST_CASE("a convex mesh, and one that is hollow, is one part: its hull") {
  Mesh cube;
  add_box(cube, {0, 0, 0}, {1, 2, 3});
  Mesh hollow = cube;
  add_box(hollow, {0.1, 0.1, 0.1}, {0.9, 1.9, 2.9});
  for (std::size_t i = 12; i < 24; ++i) std::swap(hollow.triangles[i][0], hollow.triangles[i][1]);
  for (const Mesh& mesh : {cube, hollow}) {
    const std::vector<EnclosingHull> parts = convex_parts(mesh);
    REQUIRE(parts.size() == 1);
    CHECK(parts[0].mesh.vertices == enclosing_hull(mesh.vertices).mesh.vertices);
  }
}

TEST_CASE("the number of parts is kept where more would be smaller") {
  const Mesh mesh = torus(48, 16);
  const std::vector<EnclosingHull> few = convex_parts(mesh, {.max_parts = 4});
  CHECK(few.size() == 4);
  CHECK(total_volume(few) > total_volume(convex_parts(mesh)));
  check_parts(mesh, few);
}

TEST_CASE("open, flat and single triangles have parts that hold them") {
  Mesh sheet;  // a folded sheet without volume
  sheet.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {0, 5, 4}};
  check_parts(sheet, convex_parts(sheet));
  Mesh triangle;
  triangle.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{0, 1, 2}};
  check_parts(triangle, convex_parts(triangle));
}
