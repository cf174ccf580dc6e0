// The elements and attributes of URDF that we read, and which values they may have.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <stillbase/core/error.hpp>
#include <stillbase/core/types.hpp>

namespace tinyxml2 {
class XMLElement;
}

namespace stillbase::urdf {

/// Collects findings of one file.
class Findings {
 public:
  explicit Findings(std::string source) : source_(std::move(source)) {}
  void add(int line, std::string rule, std::string message) {
    findings_.push_back({source_, line, std::move(rule), std::move(message)});
  }
  /// @throws InputError when there are any
  void raise() const {
    if (!findings_.empty()) throw InputError(findings_);
  }

 private:
  std::string source_;
  std::vector<Finding> findings_;
};

/// A piece of the file for a message: in quotes, short, without control characters.
std::string quoted(std::string_view text);

/// Holds the element and everything below it against the table: names, counts and values.
void check_element(const tinyxml2::XMLElement& element, Findings& findings);

/// Value of an attribute of a checked element; `otherwise` without element or attribute.
double number(const tinyxml2::XMLElement* element, const char* attribute, double otherwise = 0);
Vector3d vector(const tinyxml2::XMLElement* element, const char* attribute,
                const Vector3d& otherwise = Vector3d::Zero());

}  // namespace stillbase::urdf
