#include "io/field_reader.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "io/scan.hpp"

namespace stillbase::io {

MapReader::MapReader(ReadContext& context, const Node& node, std::string path)
    : context_(context), node_(node), path_(std::move(path)) {
  if (node.kind != Node::Kind::Map) {
    context_.add(node.line, "wrong-type",
                 fmt::format("{}: {} is not a map of keys and values",
                             path_.empty() ? "the file" : path_, describe(node)));
  }
}

std::string MapReader::path_of(const std::string& key) const {
  return path_.empty() ? key : path_ + "." + key;
}

int MapReader::line_of(std::string_view key) const {
  for (std::size_t i = 0; i < node_.keys.size(); ++i) {
    if (node_.keys[i] == key) return node_.key_lines[i];
  }
  return node_.line;
}

bool MapReader::has(std::string_view key) const {
  return std::find(node_.keys.begin(), node_.keys.end(), key) != node_.keys.end();
}

const Node* MapReader::child(const std::string& key, Need need) {
  known_.push_back(key);
  std::string known_path = path_of(key);
  for (std::size_t open = known_path.find('['); open != std::string::npos;
       open = known_path.find('[', open + 1)) {
    known_path.erase(open + 1, known_path.find(']', open) - open - 1);
  }
  context_.known_keys.insert(std::move(known_path));
  for (std::size_t i = 0; i < node_.keys.size(); ++i) {
    if (node_.keys[i] == key) return &node_.items[i];
  }
  if (need == Need::Required && node_.kind == Node::Kind::Map) {
    context_.add(node_.line, "missing-key", fmt::format("{}: must be stated", path_of(key)));
  }
  return nullptr;
}

bool MapReader::number(const std::string& key, double& out, Dimension dimension, const Range& range,
                       Need need) {
  const Node* node = child(key, need);
  const auto value =
      node ? read_number(context_, *node, path_of(key), dimension, range) : std::nullopt;
  if (value) out = *value;
  return value.has_value();
}

bool MapReader::integer(const std::string& key, int& out, int lower, int upper, Need need) {
  const Node* node = child(key, need);
  if (node == nullptr) return false;
  int value = 0;
  const char* end = node->text.data() + node->text.size();
  const auto [stop, error] = std::from_chars(node->text.data(), end, value);
  const bool is_integer =
      node->kind == Node::Kind::Plain && error == std::errc() && stop == end &&
      (node->text.size() == 1 || scan_number(node->text).result == Scanned::Result::Good);
  if (!is_integer || value < lower || value > upper) {
    context_.add(node->line, is_integer ? "out-of-range" : "wrong-type",
                 fmt::format("{}: {} is not allowed; must be an integer in [{}, {}]", path_of(key),
                             describe(*node), lower, upper));
    return false;
  }
  out = value;
  return true;
}

bool MapReader::unsigned_integer(const std::string& key, std::uint64_t& out, Need need) {
  const Node* node = child(key, need);
  if (node == nullptr) return false;
  std::uint64_t value = 0;
  const char* end = node->text.data() + node->text.size();
  const auto [stop, error] = std::from_chars(node->text.data(), end, value);
  if (node->kind != Node::Kind::Plain || error != std::errc() || stop != end ||
      (node->text.size() > 1 && node->text.front() == '0')) {
    context_.add(node->line, "wrong-type",
                 fmt::format("{}: {} is not allowed; must be an integer in [0, 2^64 - 1]",
                             path_of(key), describe(*node)));
    return false;
  }
  out = value;
  return true;
}

bool MapReader::flag(const std::string& key, bool& out, Need need) {
  const Node* node = child(key, need);
  if (node == nullptr) return false;
  if (node->kind != Node::Kind::Plain || (node->text != "true" && node->text != "false")) {
    context_.add(
        node->line, "wrong-type",
        fmt::format("{}: {} is not allowed; must be true or false", path_of(key), describe(*node)));
    return false;
  }
  out = node->text == "true";
  return true;
}

bool MapReader::text(const std::string& key, std::string& out, Need need) {
  const Node* node = child(key, need);
  const auto value = node ? read_text(context_, *node, path_of(key)) : std::nullopt;
  if (value) out = *value;
  return value.has_value();
}

bool MapReader::vector3(const std::string& key, Vector3d& out, Dimension dimension, Need need) {
  const Node* node = child(key, need);
  const auto value = node ? read_vector3(context_, *node, path_of(key), dimension) : std::nullopt;
  if (value) out = *value;
  return value.has_value();
}

bool MapReader::direction(const std::string& key, Vector3d& out, Need need) {
  const Node* node = child(key, need);
  const auto value = node ? read_direction(context_, *node, path_of(key)) : std::nullopt;
  if (value) out = *value;
  return value.has_value();
}

bool MapReader::unit_vector(const std::string& key, Vector3d& out, Need need) {
  const Node* node = child(key, need);
  const auto value = node ? read_unit_vector(context_, *node, path_of(key)) : std::nullopt;
  if (value) out = *value;
  return value.has_value();
}

void MapReader::pose(Pose& out) {
  vector3("position", out.position, Dimension::Length);
  if (const Node* node = child("orientation")) {
    if (const auto q = read_orientation(context_, *node, path_of("orientation"))) {
      out.orientation = *q;
    }
  }
}

void MapReader::finish() {
  for (std::size_t i = 0; i < node_.keys.size(); ++i) {
    if (std::find(known_.begin(), known_.end(), node_.keys[i]) != known_.end()) continue;
    context_.add(node_.key_lines[i], "unknown-key",
                 fmt::format("'{}' is not known{}; allowed: {}", path_of(node_.keys[i]),
                             did_you_mean(node_.keys[i], known_), list_of(known_)));
  }
}

}  // namespace stillbase::io
