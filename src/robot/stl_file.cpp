#include "robot/stl_file.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "robot/joined_mesh.hpp"
#include "robot/mesh_text.hpp"

namespace stillbase {

namespace {

constexpr std::size_t kStlHeader = 80, kStlCount = 4, kStlTriangle = 50;  // bytes

std::uint32_t stated_triangles(std::string_view text) {
  std::uint32_t count = 0;  // little-endian, as every machine that this is built for
  std::memcpy(&count, text.data() + kStlHeader, sizeof(count));
  return count;
}

Mesh read_binary_stl(std::string_view triangles) {
  const std::size_t count = triangles.size() / kStlTriangle;
  check_triangle_count(count);
  JoinedMesh mesh(count);
  for (; !triangles.empty(); triangles.remove_prefix(kStlTriangle)) {
    std::array<float, 12> numbers;  // the normal and three corners; two bytes follow
    std::memcpy(numbers.data(), triangles.data(), sizeof(numbers));
    std::array<int, 3> triangle{};
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector3d vertex(numbers[3 * c + 3], numbers[3 * c + 4], numbers[3 * c + 5]);
      for (const double value : vertex) {
        const std::string fault = coordinate_fault(value);
        if (!fault.empty()) throw std::runtime_error(fault);
      }
      triangle[c] = mesh.vertex(vertex);
    }
    mesh.add(triangle);
  }
  return mesh.take();
}

/// Compared without regard to case: some programs write FACET and VERTEX.
bool is_word(std::string_view word, std::string_view lower) {
  return word.size() == lower.size() &&
         std::equal(word.begin(), word.end(), lower.begin(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

/// What stands between the words of corners is passed over: normals, names, colours.
Mesh read_ascii_stl(std::string_view text) {
  constexpr std::size_t kBytesPerTriangle = 150;  // or more, as programs write them
  JoinedMesh mesh(text.size() / kBytesPerTriangle);
  std::string_view unread = text;
  const char* place = text.data();  // of the word that is read
  try {
    std::array<int, 3> triangle{};
    std::size_t corners = 0;
    for (std::string_view word; !(word = take_word(unread)).empty();) {
      place = word.data();
      if (is_word(word, "vertex")) {
        if (corners == 3) throw std::runtime_error("a facet has more than three corners");
        Vector3d vertex;
        for (double& value : vertex) value = coordinate_in(take_word(unread));
        triangle[corners++] = mesh.vertex(vertex);
      } else if (is_word(word, "endloop") || is_word(word, "endfacet")) {
        if (corners == 3) mesh.add(triangle);
        if (corners % 3 != 0) throw std::runtime_error("a facet has fewer than three corners");
        corners = 0;
      } else if (is_word(word, "solid") || is_word(word, "endsolid")) {
        unread.remove_prefix(std::min(unread.find_first_of("\r\n"), unread.size()));  // its name
      }
    }
    place = unread.data();
    if (corners != 0) throw std::runtime_error("the file ends within a facet");
  } catch (const std::runtime_error& error) {
    throw at_line(text, place, error.what());
  }
  return mesh.take();
}

}  // namespace

Mesh read_stl(std::string_view text) {
  const bool has_count = text.size() >= kStlHeader + kStlCount;
  const std::uint64_t count = has_count ? stated_triangles(text) : 0;
  const std::uint64_t length = kStlHeader + kStlCount + kStlTriangle * count;
  if (has_count && text.size() == length) {
    return read_binary_stl(text.substr(kStlHeader + kStlCount));
  }
  const std::string_view words = without_byte_order_mark(text);
  std::string_view unread = words;
  if (is_word(take_word(unread), "solid")) return read_ascii_stl(words);
  if (!has_count) throw std::runtime_error("is no STL file: it is too short");
  throw std::runtime_error(
      fmt::format("is no STL file: it does not begin with 'solid', and its {} bytes are not the {} "
                  "of the {} triangles that it states",
                  text.size(), length, count));
}

}  // namespace stillbase
