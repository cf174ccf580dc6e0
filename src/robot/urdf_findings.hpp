// What is wrong with a URDF file, and what was left out of it or assumed.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <stillbase/core/error.hpp>

namespace stillbase::urdf {

/// Collects what is wrong with one file, and what was left out of it or assumed.
class Findings {
 public:
  explicit Findings(std::string source) : source_(std::move(source)) {}
  void add(int line, std::string rule, std::string message) {
    findings_.push_back({source_, line, std::move(rule), std::move(message)});
  }
  /// A remark: nothing is refused for it. Remarks of one rule and message are one kind.
  /// @param subject joint or link that it is about; empty: the message says it
  void remark(int line, const std::string& rule, const std::string& message,
              const std::string& subject = {});
  /// A remark upon a part that is left out, which left_out() names, too.
  void leave_out(int line, const std::string& rule, const std::string& what) {
    remark(line, rule, what + ": left out");
    left_out_.push_back({source_, line, rule, what});
  }
  const std::vector<Finding>& left_out() const { return left_out_; }
  /// One finding per kind, in the order of the file: first line, number of times, subjects.
  std::vector<Finding> remarks() const;
  /// @throws InputError when anything is wrong
  void raise() const {
    if (!findings_.empty()) throw InputError(findings_);
  }

 private:
  struct Kind {
    int line = 0, count = 0;
    std::vector<std::string> subjects;
  };
  std::string source_;
  std::vector<Finding> findings_, left_out_;
  std::map<std::pair<std::string, std::string>, Kind> remarks_;  ///< by rule and message
};

/// A piece of the file for a message: in quotes, short, without control characters.
std::string in_quotes(std::string_view text);

}  // namespace stillbase::urdf
