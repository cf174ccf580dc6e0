#include "io/json.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace stillbase::io {

namespace {

/// On one line, with a space after commas and colons.
void write_flat(const Json& json, std::string& out) {
  if (!json.is_structured()) {
    out += json.dump();
    return;
  }
  out += json.is_array() ? '[' : '{';
  bool is_first = true;
  for (auto it = json.begin(); it != json.end(); ++it) {
    if (!is_first) out += ", ";
    is_first = false;
    if (json.is_object()) out += Json(it.key()).dump() + ": ";
    write_flat(*it, out);
  }
  out += json.is_array() ? ']' : '}';
}

void write(const Json& json, std::size_t depth, std::string& out) {
  const auto is_plain = [](const Json& value) { return !value.is_structured(); };
  std::string flat;
  write_flat(json, flat);
  const bool is_list = json.is_array() && std::all_of(json.begin(), json.end(), is_plain);
  constexpr std::size_t kLineLength = 100;
  if (!json.is_structured() || is_list || flat.size() + 2 * depth <= kLineLength) {
    out += flat;
    return;
  }
  const std::string indent(2 * (depth + 1), ' ');
  out += json.is_array() ? "[\n" : "{\n";
  bool is_first = true;
  for (auto it = json.begin(); it != json.end(); ++it) {
    if (!is_first) out += ",\n";
    is_first = false;
    out += indent;
    if (json.is_object()) out += Json(it.key()).dump() + ": ";
    write(*it, depth + 1, out);
  }
  out += '\n' + std::string(2 * depth, ' ');
  out += json.is_array() ? ']' : '}';
}

}  // namespace

Json number_json(double x) {
  if (!std::isfinite(x)) {
    throw NotFiniteError("a number that is not finite cannot be written");
  }
  return x;
}

Json array_json(const Eigen::Ref<const Eigen::VectorXd>& v) {
  Json array = Json::array();
  for (const double x : v) array.push_back(number_json(x));
  return array;
}

Json quaternion_json(const Eigen::Quaterniond& q) {
  return {{"w", number_json(q.w())},
          {"x", number_json(q.x())},
          {"y", number_json(q.y())},
          {"z", number_json(q.z())}};
}

Json pose_json(const Pose& pose) {
  return {{"position", array_json(pose.position)},
          {"orientation", quaternion_json(pose.orientation)}};
}

std::string pretty(const Json& json) {
  std::string out;
  write(json, 0, out);
  return out + '\n';
}

bool is_json(std::string_view text) { return Json::accept(text); }

std::string canonical(const Json& json) { return nlohmann::json(json).dump(); }

}  // namespace stillbase::io
