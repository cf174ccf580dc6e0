#include "io/json.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace stillbase::io {

namespace {

void write(const Json& json, int depth, std::string& out) {
  const auto is_plain = [](const Json& value) { return !value.is_structured(); };
  const bool fits_a_line = !json.is_structured() || json.empty() ||
                           (json.is_array() && std::all_of(json.begin(), json.end(), is_plain));
  if (fits_a_line) {
    if (!json.is_array()) {
      out += json.dump();
      return;
    }
    out += '[';
    for (std::size_t i = 0; i < json.size(); ++i) {
      if (i > 0) out += ", ";
      out += json[i].dump();
    }
    out += ']';
    return;
  }
  const std::string indent(2 * (static_cast<std::size_t>(depth) + 1), ' ');
  out += json.is_array() ? "[\n" : "{\n";
  bool is_first = true;
  for (auto it = json.begin(); it != json.end(); ++it) {
    if (!is_first) out += ",\n";
    is_first = false;
    out += indent;
    if (json.is_object()) out += Json(it.key()).dump() + ": ";
    write(*it, depth + 1, out);
  }
  out += '\n' + std::string(2 * static_cast<std::size_t>(depth), ' ');
  out += json.is_array() ? ']' : '}';
}

}  // namespace

Json number_json(double x) {
  if (!std::isfinite(x)) {
    throw std::invalid_argument("a number that is not finite cannot be written");
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

std::string canonical(const Json& json) { return nlohmann::json(json).dump(); }

}  // namespace stillbase::io
