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

/// A part that lies along x, on a joint at `origin`; angles of its shape have few digits.
inline std::string lying_part(const std::string& name, const std::string& parent,
                              const std::string& type, const std::string& origin,
                              const std::string& axis, double mass = 2) {
  return "<link name=\"" + name + "\"><inertial><origin xyz=\"0.15 0 0\"/><mass value=\"" +
         std::to_string(mass) +
         "\"/><inertia ixx=\"0.02\" iyy=\"0.02\" izz=\"0.02\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>"
         "</inertial><collision><origin xyz=\"0.15 0 0\" rpy=\"0 1.5707963 0\"/><geometry>"
         "<capsule radius=\"0.04\" length=\"0.14\"/></geometry></collision></link>\n"
         "<joint name=\"to_" +
         name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + name +
         "\"/><origin xyz=\"" + origin + "\"/><axis xyz=\"" + axis + "\"/><limit lower=\"" +
         (type == "prismatic" ? "0\" upper=\"0.3" : "-2.5\" upper=\"2.5") +
         "\" velocity=\"1\" effort=\"60\"/></joint>\n";
}

/// A column, the foot of lying parts.
inline std::string column() {
  return "<link name=\"foot\"><inertial><origin xyz=\"0 0 0.2\"/><mass value=\"3\"/><inertia "
         "ixx=\"0.05\" iyy=\"0.05\" izz=\"0.02\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>"
         "<collision><origin xyz=\"0 0 0.15\"/><geometry><cylinder radius=\"0.05\" length=\"0.3\"/>"
         "</geometry></collision></link>\n";
}

inline std::string tool_on(const std::string& link, const std::string& origin) {
  return "<link name=\"tool\"/><joint name=\"tip\" type=\"fixed\"><parent link=\"" + link +
         "\"/><child link=\"tool\"/><origin xyz=\"" + origin + "\"/></joint>\n";
}

/// `joints` turning joints about one axis on a column.
inline std::string planar_arm(int joints, const std::string& axis) {
  std::string text = column(), parent = "foot";
  for (int k = 1; k <= joints; ++k) {
    const std::string name = "part_" + std::to_string(k);
    text += lying_part(name, parent, "revolute", k == 1 ? "0 0 0.4" : "0.35 0 0", axis);
    parent = name;
  }
  return text + tool_on(parent, "0.35 0 0");
}

/// Two turning joints with upright axes, a quill that slides down and turns: its tool points at the
/// arm's foot. @param shoulder height, @param reach of each part, m
inline std::string scara_arm(const std::string& shoulder, const std::string& reach) {
  const std::string quill =
      "<inertial><mass value=\"0.5\"/><inertia ixx=\"0.002\" iyy=\"0.002\" "
      "izz=\"0.001\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
  const auto joint = [](const std::string& name, const std::string& type, const std::string& parent,
                        const std::string& child, const std::string& limits) {
    return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
           "\"/><child link=\"" + child + "\"/><axis xyz=\"0 0 -1\"/><limit " + limits +
           " velocity=\"1\" effort=\"60\"/></joint>\n";
  };
  return column() + lying_part("upper", "foot", "revolute", "0 0 " + shoulder, "0 0 1", 4) +
         lying_part("fore", "upper", "revolute", reach + " 0 0.1", "0 0 1", 4) +
         "<link name=\"wrist\">" + quill +
         "</link><joint name=\"end\" type=\"fixed\"><parent "
         "link=\"fore\"/><child link=\"wrist\"/><origin xyz=\"" +
         reach + " 0 0\"/></joint>\n" + "<link name=\"quill\">" + quill +
         "<collision><geometry><cylinder radius=\"0.015\" "
         "length=\"0.3\"/></geometry></collision></link>" +
         joint("slide", "prismatic", "wrist", "quill", "lower=\"0\" upper=\"0.2\"") +
         "<link name=\"flange\">" + quill + "</link>" +
         joint("turn", "revolute", "quill", "flange", "lower=\"-3\" upper=\"3\"") +
         tool_on("flange", "0 0 -0.2");
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
