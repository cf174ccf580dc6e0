#include "robot/ply_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "robot/mesh_text.hpp"
#include "robot/polygons.hpp"
#include "robot/urdf_findings.hpp"

namespace stillbase {

namespace {

enum class Number { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

std::optional<Number> number_named(const std::string& name) {
  using enum Number;
  if (name == "char" || name == "int8") return Int8;
  if (name == "uchar" || name == "uint8") return Uint8;
  if (name == "short" || name == "int16") return Int16;
  if (name == "ushort" || name == "uint16") return Uint16;
  if (name == "int" || name == "int32") return Int32;
  if (name == "uint" || name == "uint32") return Uint32;
  if (name == "float" || name == "float32") return Float32;
  if (name == "double" || name == "float64") return Float64;
  return std::nullopt;
}

struct Property {
  std::string name;
  Number number = Number::Float32;
  std::optional<Number> length;  ///< of a list
};

struct Element {
  std::string name;
  std::uintmax_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  bool is_ascii = true;
  std::endian order = std::endian::little;
  std::vector<Element> elements;
};

std::runtime_error wrong(std::string_view line) {
  return std::runtime_error("its header has a wrong line, " + urdf::in_quotes(line));
}

Property read_property(std::istringstream& words, std::string_view line) {
  std::string type, length;
  words >> type;
  Property out;
  if (type == "list") {
    words >> length >> type;
    out.length = number_named(length);
    const bool is_whole =
        out.length && *out.length != Number::Float32 && *out.length != Number::Float64;
    if (!is_whole) throw wrong(line);
  }
  const std::optional<Number> number = number_named(type);
  if (!number || !(words >> out.name)) throw wrong(line);
  out.number = *number;
  return out;
}

/// Takes the header off a text.
Header take_header(std::string_view& text) {
  Header out;
  bool has_format = false;
  for (bool is_first = true;; is_first = false) {
    const std::size_t end = text.find('\n');
    if (end == text.npos) throw std::runtime_error("its header has no end");
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    std::istringstream words{std::string(line)};
    std::string word;
    words >> word;
    if (is_first) {
      if (word != "ply") throw wrong(line);
    } else if (word == "format") {
      std::string kind;
      words >> kind;
      out.is_ascii = kind == "ascii";
      has_format = out.is_ascii || kind == "binary_little_endian" || kind == "binary_big_endian";
      if (kind == "binary_big_endian") out.order = std::endian::big;
      if (!has_format) throw wrong(line);
    } else if (word == "element") {
      Element& element = out.elements.emplace_back();
      if (!(words >> element.name >> element.count)) throw wrong(line);
    } else if (word == "property" && !out.elements.empty()) {
      out.elements.back().properties.push_back(read_property(words, line));
    } else if (word == "end_header") {
      if (!has_format) throw std::runtime_error("its header states no format");
      return out;
    } else if (word != "comment" && word != "obj_info" && !word.empty()) {
      throw wrong(line);
    }
  }
}

/// What follows the header, number by number. Each takes a byte or more: no count is too large for
/// more than the length of the file.
class Numbers {
 public:
  bool is_ascii() const { return is_ascii_; }
  /// Of the number that comes next.
  const char* place() const { return text_.data(); }
  Numbers(const Header& header, std::string_view text)
      : is_ascii_(header.is_ascii), is_swapped_(header.order != std::endian::native), text_(text) {}

  double next(Number number) {
    if (is_ascii_) return next_word();
    switch (number) {
      case Number::Int8:
        return next_bytes<std::int8_t>();
      case Number::Uint8:
        return next_bytes<std::uint8_t>();
      case Number::Int16:
        return next_bytes<std::int16_t>();
      case Number::Uint16:
        return next_bytes<std::uint16_t>();
      case Number::Int32:
        return next_bytes<std::int32_t>();
      case Number::Uint32:
        return next_bytes<std::uint32_t>();
      case Number::Float32:
        return next_bytes<float>();
      case Number::Float64:
        return next_bytes<double>();
    }
    return 0;
  }

  /// A length or an index.
  std::size_t next_whole(Number number) {
    const double value = next(number);
    if (!(value >= 0 && value < 0x1p31) || value != std::floor(value)) {
      throw std::runtime_error("a length or an index is not a whole number from 0 to 2^31 - 1");
    }
    return static_cast<std::size_t>(value);
  }

 private:
  static std::runtime_error ended() {
    return std::runtime_error("is shorter than its header says");
  }

  double next_word() {
    const std::string_view word = take_word(text_);
    if (word.empty()) throw ended();
    return number_in(word);
  }

  template <class T>
  double next_bytes() {
    std::array<char, sizeof(T)> bytes;
    if (text_.size() < bytes.size()) throw ended();
    std::copy_n(text_.begin(), bytes.size(), bytes.begin());
    text_.remove_prefix(bytes.size());
    if (is_swapped_) std::reverse(bytes.begin(), bytes.end());
    return static_cast<double>(std::bit_cast<T>(bytes));
  }

  bool is_ascii_, is_swapped_;
  std::string_view text_;
};

Vector3d read_vertex(const Element& element, Numbers& numbers) {
  Vector3d vertex = Vector3d::Constant(std::nan(""));
  for (const Property& property : element.properties) {
    if (property.length) {
      for (std::size_t left = numbers.next_whole(*property.length); left > 0; --left) {
        numbers.next(property.number);
      }
      continue;
    }
    const double value = numbers.next(property.number);
    if (property.name.size() != 1) continue;
    const std::size_t axis = std::string_view("xyz").find(property.name[0]);
    if (axis < 3) vertex[static_cast<Eigen::Index>(axis)] = value;
  }
  for (const double value : vertex) {
    if (std::isnan(value))
      throw std::runtime_error("a vertex is not finite, or lacks a coordinate");
    if (const std::string fault = coordinate_fault(value); !fault.empty()) {
      throw std::runtime_error(fault);
    }
  }
  return vertex;
}

/// Adds the triangles of a face. Other elements are passed over.
class FaceReader {
 public:
  explicit FaceReader(Mesh& mesh) : mesh_(mesh), divider_(mesh) {}

  void read(const Element& element, Numbers& numbers) {
    for (const Property& property : element.properties) {
      if (!property.length) {
        numbers.next(property.number);
        continue;
      }
      const bool is_face = element.name == "face" &&
                           (property.name == "vertex_indices" || property.name == "vertex_index");
      polygon_.clear();
      for (std::size_t left = numbers.next_whole(*property.length); left > 0; --left) {
        if (!is_face) {
          numbers.next(property.number);
          continue;
        }
        const std::size_t index = numbers.next_whole(property.number);
        if (index >= mesh_.vertices.size()) {
          throw std::runtime_error("a face names a vertex that is not there");
        }
        polygon_.push_back(static_cast<int>(index));
      }
      divider_.add(polygon_);
    }
  }

 private:
  Mesh& mesh_;
  PolygonDivider divider_;
  std::vector<int> polygon_;
};

}  // namespace

Mesh read_ply(std::string_view text) {
  std::string_view unread = text;
  const Header header = take_header(unread);
  Numbers numbers(header, unread);
  Mesh mesh;
  FaceReader faces(mesh);
  try {
    for (const Element& element : header.elements) {
      if (element.count > text.size()) throw std::runtime_error("is shorter than its header says");
      if (element.count > 0 && element.properties.empty()) {
        throw std::runtime_error("its " + urdf::in_quotes(element.name) + " has no properties");
      }
      for (std::uintmax_t i = 0; i < element.count; ++i) {
        if (element.name == "vertex") {
          mesh.vertices.push_back(read_vertex(element, numbers));
        } else {
          faces.read(element, numbers);
        }
      }
    }
  } catch (const std::runtime_error& error) {
    if (!numbers.is_ascii()) throw;
    throw at_line(text, numbers.place(), error.what());
  }
  return mesh;
}

}  // namespace stillbase
