#include "export/mat_writer.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <stdexcept>

namespace stillbase::mat {

namespace {

enum DataType : std::uint32_t {
  kInt8 = 1,
  kUint8 = 2,
  kUint16 = 4,
  kInt32 = 5,
  kUint32 = 6,
  kDouble = 9,
  kMatrix = 14
};
enum ArrayClass : std::uint32_t {
  kCellClass = 1,
  kStructClass = 2,
  kCharClass = 4,
  kDoubleClass = 6,
  kUint8Class = 9
};
constexpr std::uint32_t kLogicalFlag = 0x0200;
constexpr std::size_t kLongestName = 63;

template <class T>
void append_bytes(std::string& bytes, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes += static_cast<char>(static_cast<unsigned char>(value >> (8 * i) & 0xff));
  }
}

/// Tag, data and padding to eight bytes.
std::string element(DataType type, const std::string& data) {
  std::string bytes;
  append_bytes<std::uint32_t>(bytes, type);
  append_bytes(bytes, static_cast<std::uint32_t>(data.size()));
  bytes += data;
  bytes.resize((bytes.size() + 7) / 8 * 8, '\0');
  return bytes;
}

std::string array(std::uint32_t flags_and_class, std::size_t rows, std::size_t columns,
                  std::string_view name, const std::string& content) {
  std::string flags, dimensions;
  append_bytes(flags, flags_and_class);
  append_bytes<std::uint32_t>(flags, 0);
  append_bytes(dimensions, static_cast<std::uint32_t>(rows));
  append_bytes(dimensions, static_cast<std::uint32_t>(columns));
  return element(kMatrix, element(kUint32, flags) + element(kInt32, dimensions) +
                              element(kInt8, std::string(name)) + content);
}

/// UTF-16 of UTF-8 text; a byte that belongs to no character becomes U+FFFD.
std::vector<std::uint16_t> utf16(std::string_view text) {
  std::vector<std::uint16_t> units;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    const unsigned char first = byte(i);
    const std::size_t length = first < 0x80           ? 1
                               : (first >> 5) == 0x6  ? 2
                               : (first >> 4) == 0xe  ? 3
                               : (first >> 3) == 0x1e ? 4
                                                      : 0;
    bool is_good = length > 0 && i + length <= text.size();
    std::uint32_t code = length == 1 ? first : first & (0x7fu >> length);
    for (std::size_t k = 1; is_good && k < length; ++k) {
      is_good = (byte(i + k) >> 6) == 0x2;
      code = code << 6 | (byte(i + k) & 0x3fu);
    }
    if (!is_good) {
      units.push_back(0xfffd);
      ++i;
      continue;
    }
    if (code >= 0x10000) {
      units.push_back(static_cast<std::uint16_t>(0xd800 + ((code - 0x10000) >> 10)));
      units.push_back(static_cast<std::uint16_t>(0xdc00 + ((code - 0x10000) & 0x3ff)));
    } else {
      units.push_back(static_cast<std::uint16_t>(code));
    }
    i += length;
  }
  return units;
}

}  // namespace

std::string real_array(const Eigen::MatrixXd& values, std::string_view name) {
  std::string data;
  for (const double x : values.reshaped()) append_bytes(data, std::bit_cast<std::uint64_t>(x));
  return array(kDoubleClass, static_cast<std::size_t>(values.rows()),
               static_cast<std::size_t>(values.cols()), name, element(kDouble, data));
}

std::string logical(bool value, std::string_view name) {
  return array(kUint8Class | kLogicalFlag, 1, 1, name,
               element(kUint8, std::string(1, value ? '\1' : '\0')));
}

std::string text_row(std::string_view text, std::string_view name) {
  std::string data;
  const std::vector<std::uint16_t> units = utf16(text);
  for (const std::uint16_t unit : units) append_bytes(data, unit);
  return array(kCharClass, units.empty() ? 0 : 1, units.size(), name, element(kUint16, data));
}

std::string cell_column(const std::vector<std::string>& cells, std::string_view name) {
  std::string content;
  for (const std::string& cell : cells) content += cell;
  return array(kCellClass, cells.size(), 1, name, content);
}

std::string structure_column(const std::vector<std::string>& keys,
                             const std::vector<std::vector<std::string>>& rows,
                             std::string_view name) {
  // The length of a name is one element without padding: type and size share a word.
  std::string content, names;
  append_bytes<std::uint16_t>(content, kInt32);
  append_bytes<std::uint16_t>(content, 4);
  append_bytes<std::uint32_t>(content, kLongestName + 1);
  for (const std::string& key : keys) {
    if (key.size() > kLongestName) throw std::invalid_argument("field name too long: " + key);
    names += key + std::string(kLongestName + 1 - key.size(), '\0');
  }
  content += element(kInt8, names);
  for (const auto& row : rows) {
    for (const std::string& piece : row) content += piece;
  }
  return array(kStructClass, rows.size(), 1, name, content);
}

std::string field_name(std::string_view word) {
  std::string name;
  for (const char c : word.substr(0, kLongestName)) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    const bool is_digit = c >= '0' && c <= '9';
    if (name.empty() && !is_letter) name = "x";
    name += is_letter || is_digit ? c : '_';
  }
  return name.empty() ? "x" : name.substr(0, kLongestName);
}

std::string file(const std::string& about, const std::vector<std::string>& variables) {
  std::string bytes = about.substr(0, 116);
  bytes.resize(116, ' ');
  bytes += std::string(8, '\0');               // no subsystem data
  append_bytes<std::uint16_t>(bytes, 0x0100);  // version
  append_bytes<std::uint16_t>(bytes, 0x4d49);  // "MI": reads "IM" where bytes are little-endian
  for (const std::string& variable : variables) bytes += variable;
  return bytes;
}

}  // namespace stillbase::mat
