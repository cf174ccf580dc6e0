// Wrong input is reported once, at the border, with all its findings together.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace stillbase {

/// One thing wrong with an input file. Printed as `file:line: rule: message`.
struct Finding {
  std::string file;     ///< as the user named it
  int line = 0;         ///< 1-based; 0: the file as a whole
  std::string rule;     ///< short name of the broken rule, e.g. "unknown-key"
  std::string message;  ///< key, value, what is allowed
};

/// Text of a finding: `file:line: rule: message` (without the line when it is 0).
std::string to_string(const Finding& finding);

/// Input refused: exit code 3. what() has one line per finding.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Finding> findings);
  const std::vector<Finding>& findings() const { return findings_; }

 private:
  std::vector<Finding> findings_;
};

/// A file could not be read or written: exit code 7.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stillbase
