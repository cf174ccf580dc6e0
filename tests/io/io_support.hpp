// What the tests of the files share.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <stillbase/core/error.hpp>
#include <stillbase/io/schema.hpp>

namespace stillbase::io_test {

inline std::string source_path(const std::string& relative) {
  return std::string(STILLBASE_SOURCE_DIR) + "/" + relative;
}

inline std::string file_text(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// The part of the reference of fields that is about problems.
inline std::string problem_fields_text() {
  const std::string text = field_reference();
  const std::size_t begin = text.find("\n## problem\n");
  return text.substr(begin, text.find("\n## ", begin + 1) - begin);
}

inline std::vector<std::string> shipped_problems() {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(source_path("problems"))) {
    if (entry.path().extension() == ".yaml") paths.push_back(entry.path().string());
  }
  return paths;
}

/// The text with the first occurrence of `from` replaced; a test that replaces nothing is wrong.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("nothing to replace: " + from);
  return text.replace(at, from.size(), to);
}

inline int line_of(const std::string& text, const std::string& part) {
  const std::size_t at = text.find(part);
  if (at == std::string::npos) throw std::logic_error("no such line: " + part);
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
}

/// What the reader refuses; empty when it accepts.
template <class Read>
std::vector<Finding> findings_of(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.findings();
  }
  return {};
}

inline std::string text_of(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings) text += to_string(finding) + "\n";
  return text;
}

}  // namespace stillbase::io_test
