// Robot files of arms as people have them, written for these tests.
#pragma once

#include <string>

namespace stillbase::cli_test {

inline std::string part_link(const std::string& name, const std::string& shape) {
  return "<link name=\"" + name +
         "\"><inertial><origin xyz=\"0 0 0.15\"/><mass value=\"2\"/><inertia ixx=\"0.02\" "
         "iyy=\"0.02\" izz=\"0.01\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>" +
         (shape.empty() ? ""
                        : "<collision><origin xyz=\"0 0 0.15\"/><geometry>" + shape +
                              "</geometry></collision>") +
         "</link>\n";
}

inline std::string part_joint(const std::string& name, const std::string& type,
                              const std::string& parent, const std::string& child,
                              const std::string& axis, const std::string& more = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/><origin xyz=\"0 0 0.3\"/><axis xyz=\"" + axis +
         "\"/><limit lower=\"" + (type == "prismatic" ? "0\" upper=\"0.04" : "-2.5\" upper=\"2.5") +
         "\" velocity=\"1\" effort=\"60\"/>" + more + "</joint>\n";
}

/// Turning joints with a shape each on a foot without mass, about z where `axes` has a z, about y
/// elsewhere; the tool lies `tool` above the last joint.
inline std::string arm_chain(const std::string& axes, const std::string& shape,
                             const std::string& tool = "0.3") {
  std::string text = "<link name=\"foot\"/>\n<gazebo/>\n", parent = "foot";
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const std::string number = std::to_string(k + 1), name = "link_" + number;
    text += part_link(name, shape);
    text +=
        part_joint("joint_" + number, "revolute", parent, name, axes[k] == 'z' ? "0 0 1" : "0 1 0");
    parent = name;
  }
  return text + "<link name=\"tool\"/><joint name=\"tip\" type=\"fixed\"><parent link=\"" + parent +
         "\"/><child link=\"tool\"/><origin xyz=\"0 0 " + tool + "\"/></joint>\n";
}

/// Two fingers on the tool, the second of which follows the first.
inline std::string gripper(const std::string& shape) {
  return part_link("left", shape) + part_link("right", shape) +
         part_joint("finger", "prismatic", "tool", "left", "1 0 0") +
         part_joint("finger_2", "prismatic", "tool", "right", "-1 0 0",
                    "<mimic joint=\"finger\"/>");
}

inline std::string robot_text(const std::string& parts) {
  return "<robot name=\"arm\">" + parts + "</robot>\n";
}

/// Six turning joints on a foot without mass, and a gripper with a coupled finger.
inline std::string six_joint_arm() {
  return robot_text(arm_chain("zyyzyz", "<capsule radius=\"0.05\" length=\"0.18\"/>") +
                    gripper(""));
}

}  // namespace stillbase::cli_test
