// Typed access to a parsed file. Every complaint names file, line, path, value, rule and what is
// allowed, and reading goes on, so that one run reports everything.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <stillbase/core/rotation.hpp>

#include "io/document.hpp"
#include "io/names.hpp"
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
                                     const std::string& path, Dimension dimension);
/// A vector of any length but zero, made a unit vector. One that is already a unit vector to
/// rounding is kept bit for bit, so that written files read back the same.
std::optional<Vector3d> read_direction(ReadContext& context, const Node& node,
                                       const std::string& path);
/// A vector that must be a unit vector to 1e-6 as written.
std::optional<Vector3d> read_unit_vector(ReadContext& context, const Node& node,
                                         const std::string& path);
/// {w, x, y, z} of norm 1 to 1e-6, {rpy: [roll, pitch, yaw]} as in URDF, or {axis: , angle: }. A
/// quaternion of norm 1 to rounding is kept bit for bit.
std::optional<Eigen::Quaterniond> read_orientation(ReadContext& context, const Node& node,
                                                   const std::string& path);

/// "; did you mean 'x'?" for the nearest candidate, or nothing when none is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

/// "a, b, c".
std::string list_of(const std::vector<std::string>& words);

/// Adds the finding "unknown-name" unless the word is among the known ones.
bool check_name(ReadContext& context, int line, const std::string& path, const std::string& word,
                const std::vector<std::string>& known, const char* what);

/// The fields of one map. The functions return true when the field is stated and good; `out` keeps
/// its value (the default) otherwise.
class MapReader {
 public:
  MapReader(ReadContext& context, const Node& node, std::string path);

  ReadContext& context() const { return context_; }
  const std::string& path() const { return path_; }
  std::string path_of(const std::string& key) const;
  int line() const { return node_.line; }
  /// Line of a key, or of the map when it is absent.
  int line_of(std::string_view key) const;

  /// The value of a key, or null.
  const Node* child(const std::string& key, Need need = Need::Optional);
  bool has(std::string_view key) const;

  bool number(const std::string& key, double& out, Dimension dimension, const Range& range = kAny,
              Need need = Need::Optional);
  bool integer(const std::string& key, int& out, int lower, int upper, Need need = Need::Optional);
  bool unsigned_integer(const std::string& key, std::uint64_t& out, Need need = Need::Optional);
  bool flag(const std::string& key, bool& out, Need need = Need::Optional);
  bool text(const std::string& key, std::string& out, Need need = Need::Optional);
  bool vector3(const std::string& key, Vector3d& out, Dimension dimension,
               Need need = Need::Optional);
  bool direction(const std::string& key, Vector3d& out, Need need = Need::Optional);
  bool unit_vector(const std::string& key, Vector3d& out, Need need = Need::Optional);
  /// Keys position and orientation.
  void pose(Pose& out);

  template <class E>
  bool choice(const std::string& key, E& out, const Names<E>& names, Need need = Need::Optional) {
    const Node* node = child(key, need);
    if (node == nullptr) return false;
    const auto word = read_text(context_, *node, path_of(key));
    if (!word) return false;
    if (const auto value = value_of(names, *word)) {
      out = *value;
      return true;
    }
    check_name(context_, node->line, path_of(key), *word, words_of(names), "allowed");
    return false;
  }

  /// Reports the keys that nobody asked for.
  void finish();

 private:
  ReadContext& context_;
  const Node& node_;
  std::string path_;
  std::vector<std::string> known_;
};

}  // namespace stillbase::io
