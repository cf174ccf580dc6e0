#include <filesystem>

#include <stillbase/core/file.hpp>
#include <stillbase/core/sha256.hpp>
#include <stillbase/io/plan_file.hpp>

#include "io/document.hpp"

namespace stillbase {

namespace {

/// The value under a key of a map, or null.
const io::Node* value_of(const io::Node* map, const std::string& key) {
  if (map == nullptr || map->kind != io::Node::Kind::Map) return nullptr;
  for (std::size_t i = 0; i < map->keys.size(); ++i) {
    if (map->keys[i] == key) return &map->items[i];
  }
  return nullptr;
}

}  // namespace

std::vector<InputFile> input_files(const std::string& problem_path) {
  const std::string text = read_text_file(problem_path, io::DocumentLimits{}.bytes);
  io::ReadContext context{problem_path, {}, {}};
  const io::Node root = io::parse_document(text, context);
  std::vector<InputFile> files{{"problem", problem_path, sha256_hex(text)}};
  for (const char* role : {"robot", "target"}) {
    const io::Node* name = value_of(value_of(&root, role), "file");
    if (name == nullptr) continue;
    const auto path = std::filesystem::path(problem_path).parent_path() / name->text;
    const std::string content = read_text_file(path.string(), io::DocumentLimits{}.bytes);
    files.push_back({role, name->text, sha256_hex(content)});
  }
  return files;
}

}  // namespace stillbase
