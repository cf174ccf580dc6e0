// STL files as the mesh reader takes them.
#include <catch2/catch.hpp>

#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "robot/joined_mesh.hpp"
#include "robot/mesh_file.hpp"
#include "robot/refusal.hpp"
#include "robot/stl_file.hpp"

using namespace stillbase;

namespace {

const std::string kFacet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n"
    " endloop\nendfacet\n";

std::string binary_with(const std::array<float, 9>& corners, std::uint32_t count = 1) {
  std::string text = "solid, as some programs begin";
  text.resize(80, ' ');
  text.append(reinterpret_cast<const char*>(&count), 4);
  text.append(12, '\0');
  text.append(reinterpret_cast<const char*>(corners.data()), sizeof(corners));
  return text.append(2, '\0');
}

std::string refusal_of_stl(const std::string& text) {
  return test::refusal_of([&] { read_stl(text); });
}

}  // namespace

TEST_CASE("STL files are binary by their length and ascii by their first word") {
  const std::array<float, 9> corners{0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::string capitals = "SOLID A\n" + kFacet + "ENDSOLID A\n";
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const std::string& text :
       {binary_with(corners), "solid a vertex of names\r\n" + kFacet + "endsolid a\n",
        "  solid\n" + kFacet, capitals}) {
    const Mesh mesh = read_stl(text);
    REQUIRE(mesh.vertices.size() == 3);
    CHECK(mesh.vertices[2] == Vector3d(0, 1, 0));
    CHECK(mesh.triangles.size() == 1);
  }
  CHECK(read_stl("solid a\n" + kFacet + "endsolid a\nsolid b\n" + kFacet).triangles.size() == 2);
}

TEST_CASE("STL files that state what cannot be are refused, ascii ones at their line") {
  const auto with = [](const std::string& rest) { return refusal_of_stl("solid a\n" + rest); };
  CHECK(with("facet\nvertex 0 0 nan\n") == "line 3: a vertex is not finite");
  CHECK(with("facet\nvertex 0 0 -1e38\n") ==
        "line 3: the coordinate -1e+38 of a vertex is beyond 1e+09");
  CHECK(with("facet\nvertex 0 x 0\n") == "line 3: 'x' is no number");
  CHECK(with("vertex 0 0 0\nvertex 0 0 0\nendloop\n") ==
        "line 4: a facet has fewer than three corners");
  CHECK(with("vertex 0 0 0\nvertex 0 0 0\nvertex 0 0 0\nvertex 0 0 0\n") ==
        "line 5: a facet has more than three corners");
  CHECK(with(kFacet + "vertex 0 0 0\n") == "line 10: the file ends within a facet");
  CHECK(with("vertex 0 0") == "line 2: '' is no number");
  CHECK(with("vertex 0 0\nendloop\n") == "line 2: 'endloop' is no number");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(refusal_of_stl(binary_with({0, 0, 0, 1, 0, 0, 0, nan, 0})) == "a vertex is not finite");
  CHECK(refusal_of_stl("") == "is no STL file: it is too short");
  std::string other = binary_with({}, 7);
  other[0] = 'x';
  CHECK(
      refusal_of_stl(other) ==
      "is no STL file: it does not begin with 'solid', and its 134 bytes are not the 434 of the 7 "
      "triangles that it states");
}

TEST_CASE("a byte order mark before the words of a mesh file is passed over") {
  const std::string mark = "\xEF\xBB\xBF";
  CHECK(read_mesh_text(mark + "solid a\n" + kFacet, ".stl").triangles.size() == 1);
  const Mesh mesh = read_mesh_text(mark + "v 1 2 3\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ".obj");
  REQUIRE(mesh.vertices.size() == 3);
  CHECK(mesh.vertices[0] == Vector3d(1, 2, 3));
  std::string binary = binary_with({0, 0, 0, 1, 0, 0, 0, 1, 0});
  binary.replace(0, mark.size(), mark);
  CHECK(read_mesh_text(binary, ".stl").triangles.size() == 1);
}

TEST_CASE("vertices that were chosen to share a hash cost no more than others") {
  // The last coordinate undoes the hash of the first two: see JoinedMesh.
  constexpr std::uint64_t kFactor = 0x9e3779b97f4a7c15u;
  std::uint64_t inverse = kFactor;
  for (int i = 0; i < 6; ++i) inverse *= 2 - kFactor * inverse;
  REQUIRE(inverse * kFactor == 1);
  constexpr int kVertices = 300'000;
  JoinedMesh mesh(kVertices);
  int chosen = 0;
  for (std::uint64_t i = 1; chosen < kVertices; ++i) {
    const double x = static_cast<double>(i), y = 1;
    std::uint64_t hash = std::bit_cast<std::uint64_t>(x) * kFactor;
    hash ^= hash >> 32;
    hash = (hash ^ std::bit_cast<std::uint64_t>(y)) * kFactor;
    hash ^= hash >> 32;
    const std::uint64_t wanted = (i << 32) | i;  // its folded half is 0
    const double z = std::bit_cast<double>(hash ^ (wanted * inverse));
    if (!(std::abs(z) < 1e9)) continue;
    mesh.vertex({x, y, z});
    ++chosen;
  }
  CHECK(mesh.steps() < 50u * kVertices);  // all pairs are 45e9
  CHECK(mesh.take().vertices.size() == kVertices);
}
