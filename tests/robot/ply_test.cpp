// PLY files as the mesh reader takes them.
#include <catch2/catch.hpp>

#include <array>
#include <bit>
#include <cstring>
#include <string>

#include "robot/ply_file.hpp"
#include "robot/refusal.hpp"

using namespace stillbase;

namespace {

const std::string kHeader =
    "comment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property double z\nproperty uchar red\nelement edge 1\nproperty list uchar short of\n"
    "element face 2\nproperty list uchar int vertex_indices\nproperty float quality\n"
    "end_header\n";

std::string bytes_of(auto value, std::endian order) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return order == std::endian::native ? bytes : std::string(bytes.rbegin(), bytes.rend());
}

/// The triangle and the quadrangle of four vertices, with colours, an edge and qualities.
std::string binary(std::endian order) {
  std::string text = kHeader;
  for (const std::array<float, 3>& v :
       {std::array{0.f, 0.f, 0.f}, {1.f, 0.f, 0.f}, {1.f, 1.f, 0.f}, {0.f, 1.f, 0.25f}}) {
    text += bytes_of(v[0], order) + bytes_of(v[1], order) + bytes_of(double{v[2]}, order) + '\7';
  }
  text += '\2' + bytes_of(std::int16_t{0}, order) + bytes_of(std::int16_t{1}, order);
  text += '\3';
  for (const int i : {0, 1, 2}) text += bytes_of(i, order);
  text += bytes_of(0.5f, order) + '\4';
  for (const int i : {0, 1, 2, 3}) text += bytes_of(i, order);
  return text + bytes_of(0.5f, order);
}

std::string refusal_of_ply(const std::string& text) {
  return test::refusal_of([&] { read_ply(text); });
}

}  // namespace

TEST_CASE("PLY files in ascii and both orders of bytes are one mesh") {
  const std::string words =
      "0 0 0 7\n1 0 0 7\r\n1 1 0 7 0 1 0.25 7\n2 0 1\n3 0 1 2 0.5\n4 0 1 2 3 0.5\n";
  for (const std::string& text :
       {"ply\nformat ascii 1.0\n" + kHeader + words,
        "ply\r\nformat binary_little_endian 1.0\n" + binary(std::endian::little),
        "ply\nformat binary_big_endian 1.0\n" + binary(std::endian::big)}) {
    const Mesh mesh = read_ply(text);
    REQUIRE(mesh.vertices.size() == 4);
    CHECK(mesh.vertices[2] == Vector3d(1, 1, 0));
    CHECK(mesh.vertices[3] == Vector3d(0, 1, 0.25));
    const std::vector<std::array<int, 3>> expected = {{0, 1, 2}, {0, 1, 2}, {0, 2, 3}};
    CHECK(mesh.triangles == expected);
    // However much is cut off, the rest is refused.
    for (std::size_t length = 0; length + 4 < text.size(); ++length) {
      INFO(length);
      CHECK(refusal_of_ply(text.substr(0, length)) != "");
    }
  }
}

TEST_CASE("PLY files that state what cannot be are refused with the reason") {
  const auto with = [](const std::string& header, const std::string& rest) {
    return refusal_of_ply("ply\nformat ascii 1.0\n" + header + "end_header\n" + rest);
  };
  const std::string vertices =
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string not_whole = "a length or an index is not a whole number from 0 to 2^31 - 1";
  const std::string faces = "element face 1\nproperty list uchar int vertex_index\n";
  CHECK(with(vertices + faces, "0 0 0\n3 0 0 1") ==
        "line 11: a face names a vertex that is not there");
  CHECK(with(vertices + faces, "0 0 0\n3 0 0 -1") == "line 11: " + not_whole);
  CHECK(with(vertices + faces, "0 0 0 1e300 0") == "line 10: " + not_whole);
  CHECK(with(vertices, "0 0 nan") == "line 8: a vertex is not finite, or lacks a coordinate");
  CHECK(with(vertices, "0 0 -1e38") == "line 8: the coordinate -1e+38 of a vertex is beyond 1e+09");
  CHECK(with(vertices, "0 0 0x") == "line 8: '0x' is no number");
  CHECK(with("element vertex 1\nproperty float x\n", "0") ==
        "line 6: a vertex is not finite, or lacks a coordinate");
  CHECK(with("element nothing 300000000\n", "") == "line 5: is shorter than its header says");
  // As many elements as the text has letters, again and again, would take hours.
  CHECK(with("element nothing 10\n", "0123456789") == "line 5: its 'nothing' has no properties");
  CHECK(with("property float x\n", "") == "its header has a wrong line, 'property float x'");
  CHECK(with("element vertex 1\nproperty list float int a\n", "") ==
        "its header has a wrong line, 'property list float int a'");
  CHECK(refusal_of_ply("ply\nend_header\n") == "its header states no format");
  CHECK(refusal_of_ply("ply\nformat ascii 1.0\nelement ") == "its header has no end");
}
