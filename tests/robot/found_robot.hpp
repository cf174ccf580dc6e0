// A robot in whose text stands one thing that was found in public files.
#pragma once

#include <string>

namespace stillbase::test {

struct Kind {
  const char* seen;  ///< where
  const char* head;  ///< before <robot>
  const char* text;  ///< inside <robot>, beside base and arm
  const char* rule;  ///< of the remark; "": there is none
  int joints;
};

constexpr const char* kInertialText =
    "<inertial><mass value=\"2\"/><inertia ixx=\".1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" "
    "izz=\"1.0E-1\"/></inertial>";

/// A base and an arm, "BODY" standing for an inertia.
inline std::string robot_of(const Kind& kind) {
  std::string text = std::string(kind.head) +
                     "<robot name=\"found\"><link name=\"base\">BODY</link><link name=\"arm\">BODY"
                     "</link><joint name=\"j\" type=\"revolute\"><parent link=\"base\"/><child "
                     "link=\"arm\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" "
                     "effort=\"5\" velocity=\"1\"/></joint>" +
                     kind.text + "</robot>";
  for (std::size_t at; (at = text.find("BODY")) != std::string::npos;) {
    text.replace(at, 4, kInertialText);
  }
  return text;
}

}  // namespace stillbase::test
