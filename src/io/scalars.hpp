// Single values of a parsed file: numbers with units, texts, vectors, directions. Every complaint
// names file, line, path, value, rule and what is allowed, and reading goes on, so that one run
// reports everything.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include <stillbase/core/rotation.hpp>

#include "io/document.hpp"
#include "io/units.hpp"

namespace stillbase::io {

/// Allowed values of a number, in SI.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool is_lower_open = false;  ///< lower itself is not allowed
  bool contains(double x) const { return (is_lower_open ? x > lower : x >= lower) && x <= upper; }
  std::string text() const;  ///< "in [0, 1]", "> 0", ">= 0"
};
inline constexpr Range kAny{};
inline constexpr Range kPositive{.lower = 0, .is_lower_open = true};
inline constexpr Range kNonNegative{.lower = 0};
/// Sizes of anything that is captured, by far: squares of them and of their inverses are numbers.
inline constexpr Range kSensible{.lower = 1e-30, .upper = 1e30};

enum class Need { Optional, Required };

/// A word or a number: no list, no map, not nothing.
bool is_scalar(const Node& node);

/// What a node is, for messages.
std::string describe(const Node& node);

/// Leading number of a text by from_chars alone: no locale, no octal, no hexadecimal.
struct Scanned {
  enum class Result { None, Good, LeadingZero, Overflow };
  Result result = Result::None;
  double value = 0;
  std::string_view remainder;  ///< of the text, after the number
};

Scanned scan_number(std::string_view text);

// Values. Each adds its finding and returns nothing when the node does not hold such a value.

std::optional<double> read_number(ReadContext& context, const Node& node, const std::string& path,
                                  Dimension dimension, const Range& range = kAny);
std::optional<std::string> read_text(ReadContext& context, const Node& node,
                                     const std::string& path);
/// Numbers of one dimension. @param size wanted length; -1: any
std::optional<std::vector<double>> read_numbers(ReadContext& context, const Node& node,
                                                const std::string& path, Dimension dimension,
                                                int size, const Range& range = kAny);
std::optional<Vector3d> read_vector3(ReadContext& context, const Node& node,
                                     const std::string& path, Dimension dimension,
                                     const Range& range = kAny);
/// A vector of any length but zero, made a unit vector. One that is already a unit vector to
/// rounding is kept bit for bit, so that written files read back the same.
std::optional<Vector3d> read_direction(ReadContext& context, const Node& node,
                                       const std::string& path);
/// A vector that must be a unit vector to 1e-6 as written.
std::optional<Vector3d> read_unit_vector(ReadContext& context, const Node& node,
                                         const std::string& path);
/// "; did you mean 'x'?" for the nearest candidate, or nothing when none is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

/// "a, b, c".
std::string list_of(const std::vector<std::string>& words);

/// Adds the finding "unknown-name" unless the word is among the known ones.
bool check_name(ReadContext& context, int line, const std::string& path, const std::string& word,
                const std::vector<std::string>& known, const char* what);

}  // namespace stillbase::io
