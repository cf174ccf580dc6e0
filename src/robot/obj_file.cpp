#include "robot/obj_file.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "robot/mesh_text.hpp"
#include "robot/polygons.hpp"
#include "robot/urdf_findings.hpp"

namespace stillbase {

namespace {

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) {
    std::string_view unread = text;
    while (!unread.empty()) {
      const std::string_view line = take_line(unread);
      try {
        read(line);
      } catch (const std::runtime_error& error) {
        throw at_line(text, line.data(), error.what());
      }
    }
    if (highest_ >= static_cast<std::int64_t>(vertices_.size())) {
      throw at_line(
          text, names_highest_,
          fmt::format("a face names vertex {}; there are {}", highest_ + 1, vertices_.size()));
    }
  }

  /// The vertices that faces name, in the order in which they do, and the faces as triangles.
  Mesh mesh() const {
    Mesh mesh;
    std::vector<int> number(vertices_.size(), -1), polygon;
    PolygonDivider divider(mesh);
    std::size_t begin = 0;
    for (const std::size_t end : ends_) {
      polygon.clear();
      for (; begin < end; ++begin) {
        const auto corner = static_cast<std::size_t>(corners_[begin]);
        if (number[corner] < 0) {
          number[corner] = static_cast<int>(mesh.vertices.size());
          mesh.vertices.push_back(vertices_[corner]);
        }
        polygon.push_back(number[corner]);
      }
      divider.add(polygon);
    }
    return mesh;
  }

 private:
  /// A line and, of a vertex or a face, those that continue it behind a backslash. The backslash of
  /// a path in a comment or a name continues nothing.
  static std::string_view take_line(std::string_view& unread) {
    std::size_t end = std::min(unread.find('\n'), unread.size());
    std::string_view words = unread.substr(0, end);
    const std::string_view first = word_of(words);
    if (first == "v" || first == "f") {
      while (end < unread.size() && is_continued(unread.substr(0, end))) {
        end = std::min(unread.find('\n', end + 1), unread.size());
      }
    }
    const std::string_view line = unread.substr(0, end);
    unread.remove_prefix(std::min(end + 1, unread.size()));
    return line;
  }

  static bool is_continued(std::string_view line) {
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line.ends_with('\\');
  }

  /// The next word of a line; the backslashes at the ends of lines are none.
  static std::string_view word_of(std::string_view& line) {
    for (;;) {
      std::string_view word = take_word(line);
      if (word.empty()) return word;
      if (word.ends_with('\\')) word.remove_suffix(1);
      if (!word.empty()) return word;
    }
  }

  void read(std::string_view line) {
    const std::string_view word = word_of(line);
    if (word == "v") {
      Vector3d vertex;
      for (double& value : vertex) value = coordinate_in(word_of(line));
      vertices_.push_back(vertex);
    } else if (word == "f") {
      read_face(line);
    }
  }

  void read_face(std::string_view line) {
    const std::size_t begin = corners_.size();
    for (std::string_view word; !(word = word_of(line)).empty();) {
      if (word.starts_with('#')) break;
      const std::int64_t corner = corner_in(word);
      if (corner > highest_) {
        highest_ = corner;
        names_highest_ = word.data();
      }
      corners_.push_back(static_cast<int>(corner));
    }
    if (corners_.size() - begin < 3) {
      corners_.resize(begin);  // points and lines enclose nothing
    } else {
      ends_.push_back(corners_.size());
    }
  }

  /// The vertex of "3", "3/1", "3//2" or "3/1/2", from 0.
  std::int64_t corner_in(std::string_view word) const {
    const std::string_view digits = word.substr(0, word.find('/'));
    std::int32_t number = 0;
    const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (fault != std::errc() || end != digits.data() + digits.size() || number == 0) {
      throw std::runtime_error(urdf::in_quotes(word) + " is no number of a vertex");
    }
    if (number > 0) return std::int64_t{number} - 1;
    const std::int64_t corner = static_cast<std::int64_t>(vertices_.size()) + number;
    if (corner >= 0) return corner;
    throw std::runtime_error(fmt::format("a face names the vertex {} before the last; there are {}",
                                         -std::int64_t{number}, vertices_.size()));
  }

  std::vector<Vector3d> vertices_;
  std::vector<int> corners_;       ///< of all faces, numbers of vertices
  std::vector<std::size_t> ends_;  ///< of each face in corners_
  std::int64_t highest_ = -1;      ///< that a face names
  const char* names_highest_ = nullptr;
};

}  // namespace

Mesh read_obj(std::string_view text) { return ObjReader(text).mesh(); }

}  // namespace stillbase
