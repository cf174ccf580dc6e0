#include "robot/mesh_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>

#include "robot/mesh_file.hpp"
#include "robot/urdf_findings.hpp"

namespace stillbase {

void check_triangle_count(std::size_t count) {
  if (count <= kMaxMeshTriangles) return;
  throw std::runtime_error(fmt::format("more than {} triangles", kMaxMeshTriangles));
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

int line_of(std::string_view text, const char* place) {
  return 1 + static_cast<int>(std::count(text.data(), place, '\n'));
}

std::runtime_error at_line(std::string_view text, const char* place, const std::string& message) {
  return std::runtime_error(fmt::format("line {}: {}", line_of(text, place), message));
}

std::string coordinate_fault(double value) {
  if (!std::isfinite(value)) return "a vertex is not finite";
  if (std::abs(value) <= kMaxMeshCoordinate) return "";
  return fmt::format("the coordinate {:g} of a vertex is beyond {:g}", value, kMaxMeshCoordinate);
}

std::string_view take_word(std::string_view& text) {
  const auto is_blank = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
  std::size_t begin = 0;
  while (begin < text.size() && is_blank(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && !is_blank(text[end])) ++end;
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

double number_in(std::string_view word) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_beyond = fault == std::errc::result_out_of_range;
  if (end != digits.data() + digits.size() || (fault != std::errc() && !is_beyond)) {
    throw std::runtime_error(urdf::in_quotes(word) + " is no number");
  }
  if (!is_beyond) return value;
  return digits.find_first_of("eE") + 1 == digits.find('-', 1) ? 0 : kInfinity;
}

double coordinate_in(std::string_view word) {
  const double value = number_in(word);
  if (const std::string fault = coordinate_fault(value); !fault.empty()) {
    throw std::runtime_error(fault);
  }
  return static_cast<float>(value);
}

}  // namespace stillbase
