// What the fuzzers and the replay of their corpus call: a text is accepted or refused with an
// InputError. Anything else (another exception, a crash, a copy that does not read back) is a bug.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include <stillbase/core/error.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/robot/suspicions.hpp>
#include <stillbase/robot/urdf_reader.hpp>

namespace stillbase::fuzz {

/// @return accepted
/// @throws what the reader must not throw, and std::logic_error for an accepted robot that is none
inline bool urdf(std::string_view text) {
  RobotModel robot;
  try {
    robot = read_urdf(text, "fuzz.urdf", "");
  } catch (const InputError& error) {
    if (error.findings().empty()) throw std::logic_error("refused without a finding");
    return false;
  }
  bool is_sound = std::isfinite(robot.total_mass()) && robot.base.inertia.allFinite() &&
                  robot.joints.size() == robot.bodies.size() && robot.p_hand.allFinite();
  for (const Body& body : robot.bodies) {
    is_sound = is_sound && body.mass > 0 && body.inertia.allFinite() && body.centroid.allFinite();
  }
  if (!is_sound) throw std::logic_error("an unsound robot was accepted");
  robot_suspicions(robot);
  return true;
}

/// The robot of every problem of the corpus: two joints on a base, a hand.
inline const std::string& robot_text() {
  static const std::string text = R"(<robot name="r">
<link name="base"><inertial><mass value="100"/>
<inertia ixx="10" iyy="10" izz="10" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="link_1"><inertial><origin xyz="0.5 0 0"/><mass value="10"/>
<inertia ixx="0.1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="link_2"><inertial><origin xyz="0.5 0 0"/><mass value="10"/>
<inertia ixx="0.1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="hand"/>
<joint name="joint_1" type="revolute"><parent link="base"/><child link="link_1"/>
<origin xyz="1 0 0"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1" effort="9"/></joint>
<joint name="joint_2" type="prismatic"><parent link="link_1"/><child link="link_2"/>
<origin xyz="1 0 0"/><axis xyz="1 0 0"/><limit lower="0" upper="1" velocity="1" effort="9"/></joint>
<joint name="tip" type="fixed"><parent link="link_2"/><child link="hand"/><origin xyz="1 0 0"/></joint>
</robot>)";
  return text;
}

/// @return accepted
inline bool problem(std::string_view text) {
  std::string copy;
  try {
    copy = problem_to_json(read_problem_text(text, "fuzz.yaml", robot_text()));
  } catch (const InputError& error) {
    if (error.findings().empty()) throw std::logic_error("refused without a finding");
    return false;
  }
  // The normalised copy reads back to the same problem. A name may come from the file's name.
  try {
    if (problem_to_json(read_problem_text(copy, "fuzz.yaml", robot_text())) == copy) return true;
  } catch (const InputError& error) {
    throw std::logic_error(std::string("the copy of an accepted problem is refused: ") +
                           error.what());
  }
  throw std::logic_error("the copy of an accepted problem reads differently");
}

/// What a fuzzer hands over.
inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace stillbase::fuzz
