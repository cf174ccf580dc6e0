// The text of a problem that the tests of its reader spoil one line at a time.
#pragma once

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <stillbase/io/problem_file.hpp>

#include "io/io_support.hpp"

namespace stillbase::io_test {

inline const std::string kProblem = R"(format: stillbase.problem
version: 1
purpose: A text that the tests spoil one line at a time.
robot:
  file: robots/planar_two_link_a.urdf
  hand: hand
  start: {joint_1: -80 deg, joint_2: 160 deg}
  base: {position: [1, 2, 3], orientation: {rpy: [0, 0, 90 deg]}}
  allowed_contacts: [[base, link_2]]
target:
  name: client
  model: rigid_body
  mass: 50 kg
  inertia: {ixx: 3, iyy: 3, izz: 3}
  shapes:
    - {position: [0, 0, 0], geometry: {box: {size: [0.6, 600 mm, 60 cm]}}}
  features:
    - {name: plus_x, point: [0.3, 0.12, 0.06], normal: [1, 0, 0]}
  state:
    linear_velocity: [-50 mm/s, 0, 0]
    angular_velocity: {axis: [1, 2, 2], rate: 5 deg/s}
impact:
  source: rigid_body
  restitution: 0.5
  joint_resistance: {model: rotor_inertia, rotor_inertia: [0.5, 0.25]}
variables:
  joints: [joint_2]
  base_attitude: {freedom: axis, axis: [0, 0, 2], max: 30 deg}
  contact_time: {lower: 1 min, upper: 70}
objective: base_angular_momentum
hand:
  constraint: axis
constraints:
  closing_speed_min: 0.01
uncertainty:
  cone_half_angle: 10 deg
obstacles:
  - {name: panel, position: [5, 5, 5], geometry: {sphere: {radius: 0.1}}}
)";

inline std::string robot_text(const std::string& name = "planar_two_link_a") {
  return file_text(source_path("problems/robots/" + name + ".urdf"));
}

inline CaptureProblem read(const std::string& text) {
  return read_problem_text(text, "test.yaml", robot_text());
}

/// One spoiled text is refused with exactly this rule at this line, and the message names these
/// parts.
inline void refuses(const std::string& text, int line, const std::string& rule,
                    const std::vector<std::string>& parts) {
  const auto findings = findings_of([&] { read(text); });
  INFO(text_of(findings));
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].file == "test.yaml");
  CHECK(findings[0].line == line);
  CHECK(findings[0].rule == rule);
  for (const std::string& part : parts) {
    CHECK_THAT(findings[0].message, Catch::Contains(part));
  }
}

inline void refuses_change(const std::string& from, const std::string& to, const std::string& rule,
                           const std::vector<std::string>& parts) {
  INFO(from << " -> " << to);
  refuses(replaced(kProblem, from, to), line_of(kProblem, from), rule, parts);
}

}  // namespace stillbase::io_test
