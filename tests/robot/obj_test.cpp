// OBJ files as the mesh reader takes them, and polygons as triangles.
#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "robot/obj_file.hpp"
#include "robot/refusal.hpp"

using namespace stillbase;

namespace {

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
using Triangles = std::vector<std::array<int, 3>>;

std::string refusal_of_obj(const std::string& text) {
  return test::refusal_of([&] { read_obj(text); });
}

/// Sum of the areas of triangles, and the size of the sum of their area vectors.
std::array<double, 2> areas(const Mesh& mesh) {
  double sum = 0;
  Vector3d vector = Vector3d::Zero();
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    const auto at = [&](std::size_t c) {
      return mesh.vertices[static_cast<std::size_t>(triangle[c])];
    };
    const Vector3d area = (at(1) - at(0)).cross(at(2) - at(0)) / 2;
    vector += area;
    sum += area.norm();
  }
  return {sum, vector.norm()};
}

}  // namespace

TEST_CASE("faces of OBJ files name their vertices in every way") {
  const std::string head = "mtllib a.mtl\no square\n# by hand in C:\\\r\n" + kSquare;
  for (const char* faces :
       {"f 1 2 3 4", "f 1/1 2/1 3/1 4/1\r\n", "f 1//1 2//1 3//1 4//1 # a comment",
        "f 1/1/1 2/2/2 3/3/3 4/4/4", "f -4 -3 -2 -1\n", "f\\\n1 2 \\\n  3\\\r\n 4\n",
        "usemtl red\n\tf\t1 2 3 4\nl 1 2\nf 1 2\nvn 0 0 1\ns off\n"}) {
    INFO(faces);
    const Mesh mesh = read_obj(head + faces);
    CHECK(mesh.vertices.size() == 4);
    CHECK(mesh.triangles == Triangles{{0, 1, 2}, {0, 2, 3}});
  }
  // Behind their face, with a colour; a vertex of no face is none.
  const Mesh later = read_obj("f 1 3 4\nv +1e0 2 3 0.5 0.5 0.5\nv 9 9 9\nv 4 5 6\nv 7 8 1e-400\n");
  REQUIRE(later.vertices.size() == 3);
  CHECK(later.vertices[1] == Vector3d(4, 5, 6));
  CHECK(later.vertices[2] == Vector3d(7, 8, 0));
}

TEST_CASE("lines of an OBJ file are looked at once") {
  CHECK(read_obj(std::string(4'000'000, '\n') + kSquare + "f 1 2 3\n").triangles.size() == 1);
  CHECK(refusal_of_obj("f 1 2 " + std::string(1'000'000, '\\') + "\n") != "");
  std::string continued = "f";
  for (int i = 0; i < 1'000'000; ++i) continued += "\\\n";
  CHECK(read_obj(continued).triangles.empty());
}

TEST_CASE("OBJ files that state what cannot be are refused at their line") {
  const auto with = [](const std::string& rest) { return refusal_of_obj(kSquare + rest); };
  CHECK(with("f 1 2 3\nf 1 2 5\n") == "line 6: a face names vertex 5; there are 4");
  CHECK(with("f 1 2 2000000000\n") == "line 5: a face names vertex 2000000000; there are 4");
  CHECK(with("f 1 2 -5\n") == "line 5: a face names the vertex 5 before the last; there are 4");
  CHECK(with("f 1 2 -2147483648\n") ==
        "line 5: a face names the vertex 2147483648 before the last; there are 4");
  CHECK(with("f 1 2 99999999999\n") == "line 5: '99999999999' is no number of a vertex");
  CHECK(with("f 0 1 2\n") == "line 5: '0' is no number of a vertex");
  CHECK(with("f 1 2 x\n") == "line 5: 'x' is no number of a vertex");
  CHECK(with("v 1 2\n") == "line 5: '' is no number");
  CHECK(with("v 1 2 nan\n") == "line 5: a vertex is not finite");
  CHECK(with("v 1 2 1e999\n") == "line 5: a vertex is not finite");
  CHECK(with("v 1 2 1e38\n") == "line 5: the coordinate 1e+38 of a vertex is beyond 1e+09");
  CHECK(with("v 1,5 2 3\n") == "line 5: '1,5' is no number");
}

TEST_CASE("a polygon that is not convex is divided into triangles that lie in it") {
  // An L, from each of its corners, seen from both sides, in every plane.
  const std::vector<std::array<double, 2>> outline = {{0, 0}, {3, 0}, {3, 1},
                                                      {1, 1}, {1, 2}, {0, 2}};
  for (std::size_t first = 0; first < outline.size(); ++first) {
    for (const bool is_reversed : {false, true}) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        std::string text;
        for (std::size_t i = 0; i < outline.size(); ++i) {
          const std::size_t k = (first + (is_reversed ? outline.size() - i : i)) % outline.size();
          std::array<double, 3> point{0.1, 0.1, 0.1};
          point[(axis + 1) % 3] = outline[k][0];
          point[(axis + 2) % 3] = outline[k][1];
          text += "v";
          for (const double x : point) text += " " + std::to_string(x);
          text += "\n";
        }
        const Mesh mesh = read_obj(text + "f 1 2 3 4 5 6\n");
        CHECK(mesh.triangles.size() == 4);
        CHECK(areas(mesh)[0] == Approx(4));
        CHECK(areas(mesh)[1] == Approx(4));
      }
    }
  }
  // A frame: the hole is reached by a slit, whose corners are named twice.
  const Mesh frame = read_obj(
      "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"
      "f 1 2 3 4 1 5 6 7 8 5\n");
  CHECK(areas(frame)[0] == Approx(12));
  CHECK(areas(frame)[1] == Approx(12));
}

TEST_CASE("the work for a polygon of many corners is bounded") {
  // A comb has as many reflex corners as ears; a star crosses itself everywhere. n^3 would
  // be 2.7e13.
  for (const bool is_star : {false, true}) {
    constexpr int kCorners = 30001;
    std::string text, face = "f";
    for (int i = 0; i < kCorners; ++i) {
      const double angle = 2 * 3.14159265 * 12347 * i / kCorners;
      text += is_star ? "v " + std::to_string(std::cos(angle)) + " " +
                            std::to_string(std::sin(angle)) + " 0\n"
                      : "v " + std::to_string(i) + " " + std::to_string(i % 2 * 10) + " 0\n";
      face += " " + std::to_string(i + 1);
    }
    if (!is_star) {
      text += "v 30000 -1000 0\nv 0 -1000 0\n";
      face += " 30002 30003";
    }
    const Mesh mesh = read_obj(text + face + "\n");
    CHECK(mesh.triangles.size() == (is_star ? kCorners : kCorners + 2) - 2);
  }
}
