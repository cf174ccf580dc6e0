// Meshes with fewer triangles.
#include <cmath>

#include <catch2/catch.hpp>

#include <stillbase/core/constants.hpp>

#include "robot/mesh_thinning.hpp"

using namespace stillbase;

namespace {

/// A sphere of triangles that share no corners, as an STL file has them.
Mesh ball(double radius, int rings) {
  Mesh mesh;
  const auto at = [&](int i, int k) {
    const double polar = kPi * i / rings, azimuth = kPi * k / rings;
    return Vector3d(radius * std::sin(polar) * std::cos(azimuth),
                    radius * std::sin(polar) * std::sin(azimuth), radius * std::cos(polar));
  };
  const auto add = [&](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const int first = static_cast<int>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
    mesh.triangles.push_back({first, first + 1, first + 2});
  };
  for (int i = 0; i < rings; ++i) {
    for (int k = 0; k < 2 * rings; ++k) {
      if (i > 0) add(at(i, k), at(i + 1, k), at(i, k + 1));
      if (i + 1 < rings) add(at(i, k + 1), at(i + 1, k), at(i + 1, k + 1));
    }
  }
  return mesh;
}

}  // namespace

TEST_CASE("a mesh that is small enough keeps every triangle and joins equal corners") {
  const Mesh mesh = ball(0.3, 8);
  const Mesh joined = thinned(mesh, mesh.triangles.size());
  CHECK(joined.triangles.size() == mesh.triangles.size());
  // Of a closed surface of triangles: vertices = 2 + triangles / 2.
  CHECK(joined.vertices.size() == 2 + mesh.triangles.size() / 2);
  CHECK(enclosed_volume(joined) == Approx(enclosed_volume(mesh)));
}

TEST_CASE("a thinned mesh has as few triangles as asked for and is still the same body") {
  const Mesh mesh = ball(0.3, 100);
  REQUIRE(mesh.triangles.size() > 39000);
  for (const std::size_t most : {20000, 5000, 500}) {
    const Mesh thin = thinned(mesh, most);
    INFO(most << ": " << thin.triangles.size());
    CHECK(thin.triangles.size() <= most);
    CHECK(thin.triangles.size() > most / 4);
    // Outside stays outside, and vertices lie within a cell of the sphere.
    const double cell = 2 * 0.3 * std::sqrt(8.0 / static_cast<double>(most));
    CHECK(enclosed_volume(thin) == Approx(4 * kPi / 3 * 0.027).epsilon(0.15));
    for (const Vector3d& v : thin.vertices) REQUIRE(std::abs(v.norm() - 0.3) < cell);
  }
}

TEST_CASE("faces without area leave no triangle") {
  Mesh mesh;
  mesh.vertices = {Vector3d(1, 2, 3), Vector3d(1, 2, 3), Vector3d(1, 2, 3)};
  mesh.triangles = {{0, 1, 2}};
  CHECK(thinned(mesh, 10).triangles.empty());
  CHECK(thinned(ball(1, 8), 0).triangles.empty());
}

TEST_CASE("meshes are thinned together, the small ones not at all") {
  std::vector<Mesh> meshes;
  for (const int rings : {8, 60, 60}) meshes.push_back(thinned(ball(0.1, rings), 100000));
  const std::size_t small = meshes.front().triangles.size();
  thin_together(meshes, 4000);
  CHECK(meshes[0].triangles.size() == small);
  CHECK(meshes[1].triangles.size() <= (4000 - small) / 2);
  CHECK(meshes[1].triangles.size() == meshes[2].triangles.size());
  CHECK(meshes[0].triangles.size() + 2 * meshes[1].triangles.size() > 2000);
}
