#include <stillbase/core/error.hpp>

#include <utility>

namespace stillbase {

namespace {

std::string join_lines(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings) {
    if (!text.empty()) text += '\n';
    text += to_string(finding);
  }
  return text;
}

}  // namespace

std::string to_string(const Finding& finding) {
  std::string text = finding.file;
  if (finding.line > 0) text += ':' + std::to_string(finding.line);
  return text + ": " + finding.rule + ": " + finding.message;
}

InputError::InputError(std::vector<Finding> findings)
    : std::runtime_error(join_lines(findings)), findings_(std::move(findings)) {}

}  // namespace stillbase
