// An element of a URDF file that is read: values are checked as they are asked for, and what was
// not asked for is remarked upon in the end.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tinyxml2.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/types.hpp>

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
  std::vector<Finding> findings_;
  std::map<std::pair<std::string, std::string>, Kind> remarks_;  ///< by rule and message
};

/// A piece of the file for a message: in quotes, short, without control characters.
std::string quoted(std::string_view text);

enum class Sign { Any, NonNegative };

class Element {
 public:
  Element(const tinyxml2::XMLElement& xml, Findings& findings) : xml_(xml), findings_(findings) {}

  int line() const { return xml_.GetLineNum(); }
  void find(std::string rule, std::string message) {
    findings_.add(line(), std::move(rule), std::move(message));
  }

  void remark(const std::string& rule, const std::string& message,
              const std::string& subject = {}) {
    findings_.remark(line(), rule, message, subject);
  }

  bool has(const char* attribute) const { return xml_.Attribute(attribute) != nullptr; }
  /// A required text must not be empty.
  std::string text(const char* attribute, bool required);
  /// One finite number. NaN after a finding.
  /// @param otherwise without the attribute; nothing: it is required
  double number(const char* attribute, Sign sign, std::optional<double> otherwise = {});
  /// Three finite numbers, alike.
  Vector3d vector(const char* attribute, Sign sign, const std::optional<Vector3d>& otherwise = {});

  /// Reads the children of this name, in file order; there must be `least` to `most` of them.
  template <class Read>
  void each(const char* name, int least, int most, Read read) {
    int count = 0;
    for (const auto* e = xml_.FirstChildElement(name); e; e = e->NextSiblingElement(name)) {
      Element child(*e, findings_);
      if (++count == most + 1) {
        child.find("repeated-element", tag() + " holds more than one <" + name + ">");
      }
      read(child);
      child.finish();
    }
    if (count < least) find("missing-element", tag() + " needs a <" + name + ">");
    children_.emplace_back(name);
  }
  /// Children that are not read and not worth a remark.
  void ignore(std::initializer_list<std::string_view> names) {
    children_.insert(children_.end(), names);
  }
  /// Children of this name are not read: a remark with the reason.
  void leave_out(const char* name, const std::string& reason);
  /// Remarks on attributes, elements and text that nobody asked for.
  void finish();
  std::string tag() const { return std::string("<") + xml_.Name() + ">"; }

 private:
  /// The text of an attribute; null, and a finding where it is required, without it.
  const char* value(const char* attribute, bool required);
  double parse(const char* attribute, std::string_view text, std::string_view part, Sign sign);
  void find_in(const char* attribute, std::string rule, const std::string& message);

  const tinyxml2::XMLElement& xml_;
  Findings& findings_;
  std::vector<std::string_view> attributes_, children_;  ///< asked for
};

inline constexpr int kAny = 1 << 20;  ///< number of elements

}  // namespace stillbase::urdf
