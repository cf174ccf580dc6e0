// Reads MATLAB's level 5 files as far as the writer makes them; every fault ends the test.
#pragma once

#include <bit>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace stillbase::export_test {

struct MatVariable {
  std::string name;
  int array_class = 0;  ///< 1 cell, 2 structure, 4 text, 6 double, 9 uint8 (logical)
  bool is_logical = false;
  std::size_t rows = 0, columns = 0;
  Eigen::MatrixXd values;
  std::u16string text;
  std::vector<MatVariable> cells;
  std::vector<std::string> keys;
  std::vector<std::map<std::string, MatVariable>> structures;

  const MatVariable& at(const std::string& key) const { return structures.at(0).at(key); }
  std::string ascii() const { return {text.begin(), text.end()}; }
};

class MatReader {
 public:
  explicit MatReader(std::string bytes) : bytes_(std::move(bytes)) {}

  std::map<std::string, MatVariable> read() {
    require(bytes_.size() >= 128 && bytes_.rfind("MATLAB 5.0 MAT-file", 0) == 0, "header");
    require(bytes_.substr(124, 4) == std::string("\0\1IM", 4), "version and byte order");
    std::map<std::string, MatVariable> variables;
    for (std::size_t at = 128; at < bytes_.size();) {
      require(at % 8 == 0, "variables begin at multiples of eight bytes");
      const MatVariable variable = array(at);
      require(variables.emplace(variable.name, variable).second, "a name twice");
    }
    return variables;
  }

 private:
  struct Element {
    std::uint32_t type;
    std::size_t begin, size;
  };

  static void require(bool holds, const std::string& what) {
    if (!holds) throw std::runtime_error("MAT-file: " + what);
  }
  template <class T>
  T number(std::size_t at) const {
    require(at + sizeof(T) <= bytes_.size(), "end of the file");
    T value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      value |=
          static_cast<T>(static_cast<T>(static_cast<unsigned char>(bytes_[at + i])) << (8 * i));
    }
    return value;
  }
  /// Tag and data; `at` moves behind the padding.
  Element element(std::size_t& at) const {
    const auto word = number<std::uint32_t>(at);
    if (word >> 16 != 0) {  // small element: data in the tag
      const Element small{word & 0xffff, at + 4, word >> 16};
      require(small.size <= 4, "size of a small element");
      at += 8;
      return small;
    }
    const Element whole{word, at + 8, number<std::uint32_t>(at + 4)};
    require(whole.begin + whole.size <= bytes_.size(), "element behind the end");
    at = whole.begin + (whole.size + 7) / 8 * 8;
    return whole;
  }
  Element element_of(std::size_t& at, std::uint32_t type) const {
    const Element found = element(at);
    require(found.type == type, "type of an element");
    return found;
  }

  MatVariable array(std::size_t& at) const {
    const Element whole = element_of(at, 14);
    std::size_t in = whole.begin;
    const std::size_t end = whole.begin + whole.size;
    MatVariable out;
    const Element flags = element_of(in, 6);
    require(flags.size == 8, "array flags");
    out.array_class = static_cast<int>(number<std::uint32_t>(flags.begin) & 0xff);
    out.is_logical = (number<std::uint32_t>(flags.begin) & 0x0200) != 0;
    const Element dimensions = element_of(in, 5);
    require(dimensions.size == 8, "two dimensions");
    out.rows = number<std::uint32_t>(dimensions.begin);
    out.columns = number<std::uint32_t>(dimensions.begin + 4);
    const Element name = element_of(in, 1);
    out.name = bytes_.substr(name.begin, name.size);
    content(out, in);
    require(in == end, "size of an array");
    return out;
  }

  void content(MatVariable& out, std::size_t& in) const {
    const std::size_t count = out.rows * out.columns;
    if (out.array_class == 6) {
      const Element data = element_of(in, 9);
      require(data.size == 8 * count, "size of the numbers");
      out.values.resize(static_cast<Eigen::Index>(out.rows),
                        static_cast<Eigen::Index>(out.columns));
      for (std::size_t i = 0; i < count; ++i) {
        out.values.data()[i] = std::bit_cast<double>(number<std::uint64_t>(data.begin + 8 * i));
      }
    } else if (out.array_class == 9) {
      const Element data = element_of(in, 2);
      require(data.size == count, "size of the flags");
      out.values = Eigen::MatrixXd::Constant(1, 1, bytes_[data.begin]);
    } else if (out.array_class == 4) {
      const Element data = element_of(in, 4);
      require(data.size == 2 * count, "size of the text");
      for (std::size_t i = 0; i < count; ++i) {
        out.text += static_cast<char16_t>(number<std::uint16_t>(data.begin + 2 * i));
      }
    } else if (out.array_class == 1) {
      for (std::size_t i = 0; i < count; ++i) out.cells.push_back(array(in));
    } else {
      require(out.array_class == 2, "known class");
      structure(out, in, count);
    }
  }

  void structure(MatVariable& out, std::size_t& in, std::size_t count) const {
    const Element length = element_of(in, 5);
    const std::size_t each = number<std::uint32_t>(length.begin);
    const Element names = element_of(in, 1);
    require(each > 0 && names.size % each == 0, "field names");
    for (std::size_t i = 0; i < names.size / each; ++i) {
      const std::string padded = bytes_.substr(names.begin + i * each, each);
      require(padded.find('\0') != std::string::npos, "field name ends");
      out.keys.push_back(padded.substr(0, padded.find('\0')));
    }
    for (std::size_t i = 0; i < count; ++i) {
      out.structures.emplace_back();
      for (const std::string& key : out.keys) {
        require(out.structures.back().emplace(key, array(in)).second, "a field twice");
      }
    }
  }

  std::string bytes_;
};

}  // namespace stillbase::export_test
