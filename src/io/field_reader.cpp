#include "io/field_reader.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include <stillbase/core/file.hpp>

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

void MapReader::refuse(const std::string& key, std::string rule, const std::string& what) {
  context_.add(line_of(key), std::move(rule), fmt::format("{}: {}", path_of(key), what));
}

void MapReader::note(const std::string& key) {
  std::string known_path = path_of(key);
  for (std::size_t open = known_path.find('['); open != std::string::npos;
       open = known_path.find('[', open + 1)) {
    known_path.erase(open + 1, known_path.find(']', open) - open - 1);
  }
  context_.known_keys.insert(std::move(known_path));
}

const Node* MapReader::child(const std::string& key, Need need) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  note(key);
  const Node* node = find(key);
  if (node == nullptr && need == Need::Required) miss(key);
  return node;
}

void MapReader::miss(const std::string& key) {
  if (node_.kind != Node::Kind::Map) return;
  refuse(key, "missing-key", "must be stated");
  missing_.push_back(key);
}

void MapReader::operator()(const std::string& key, const Value& value, std::string_view,
                           const About& about) {
  if (about.when && !*about.when) return;
  const Node* node = child(key);
  if (!about.is_used) {
    if (node != nullptr) refuse(key, "not-used", "belongs to " + about.owner);
    return;
  }
  if (node == nullptr) {
    const bool is_needed = about.when || about.need == Need::Required;
    const bool is_left_out = value.leave_out && value.leave_out(context_, path_of(key), node_.line);
    if (is_needed && !is_left_out) miss(key);
  } else if (!value.read(context_, *node, path_of(key))) {
    refused_.insert(key);
  }
}

bool MapReader::states(const std::string& key, bool) {
  note(key);
  elsewhere_.push_back(key);
  return has(key);
}

int MapReader::one_of(const std::vector<std::string>& keys, int, const std::string& rule) {
  int found = -1, count = 0;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (child(keys[i]) == nullptr) continue;
    if (count++ == 0) found = static_cast<int>(i);
  }
  if (count == 1 || node_.kind != Node::Kind::Map) return found;
  context_.add(node_.line, rule,
               fmt::format("{}: states {} of them; must state exactly one of {}", path_, count,
                           list_of(keys)));
  return -1;
}

void MapReader::not_both(const std::string& a, const std::string& b) {
  child(b);
  if (has(a) && has(b)) {
    refuse(b, "not-used", fmt::format("is stated beside {}; state one of them", a));
  }
}

std::optional<std::string> MapReader::read_file(const std::string& key, const std::string& name,
                                                const std::optional<std::string>& folder,
                                                std::string& full_path) {
  if (!folder) {
    refuse(key, "not-used",
           fmt::format("'{}' cannot be read from here; state its content in place", name));
    return std::nullopt;
  }
  full_path = (std::filesystem::path(*folder) / name).string();
  try {
    return read_text_file(full_path, DocumentLimits{}.bytes);
  } catch (const InputError& error) {
    for (const Finding& finding : error.findings()) {
      refuse(key, finding.rule, fmt::format("{}: {}", full_path, finding.message));
    }
  }
  return std::nullopt;
}

void MapReader::finish() {
  std::vector<std::string> near = known_;
  near.insert(near.end(), elsewhere_.begin(), elsewhere_.end());
  for (std::size_t i = 0; i < node_.keys.size(); ++i) {
    const std::string& key = node_.keys[i];
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    context_.add(node_.key_lines[i], "unknown-key",
                 fmt::format("'{}' is not known{}; allowed: {}", path_of(key),
                             did_you_mean(key, near), list_of(known_)));
  }
}

}  // namespace stillbase::io
