// Spacecraft that a problem puts together, and first problems for arms.
#include <catch2/catch.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;

namespace {

std::string part_link(const std::string& name, const std::string& shape) {
  return "<link name=\"" + name +
         "\"><inertial><origin xyz=\"0 0 0.15\"/><mass value=\"2\"/><inertia ixx=\"0.02\" "
         "iyy=\"0.02\" izz=\"0.01\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>" +
         (shape.empty() ? ""
                        : "<collision><origin xyz=\"0 0 0.15\"/><geometry>" + shape +
                              "</geometry></collision>") +
         "</link>\n";
}

std::string part_joint(const std::string& name, const std::string& type, const std::string& parent,
                       const std::string& child, const std::string& axis,
                       const std::string& more = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/><origin xyz=\"0 0 0.3\"/><axis xyz=\"" + axis +
         "\"/><limit lower=\"" + (type == "prismatic" ? "0\" upper=\"0.04" : "-2.5\" upper=\"2.5") +
         "\" velocity=\"1\" effort=\"60\"/>" + more + "</joint>\n";
}

/// Six turning joints on a foot without mass, and a gripper with a coupled finger.
std::string six_joint_arm() {
  std::string text = "<robot name=\"arm\"><link name=\"foot\"/>\n<gazebo/>\n";
  std::string parent = "foot";
  for (int k = 1; k <= 6; ++k) {
    const std::string name = "link_" + std::to_string(k);
    text += part_link(name, "<capsule radius=\"0.05\" length=\"0.18\"/>");
    text += part_joint("joint_" + std::to_string(k), "revolute", parent, name,
                       k == 1 || k == 4 || k == 6 ? "0 0 1" : "0 1 0");
    parent = name;
  }
  text +=
      "<link name=\"tool\"/><joint name=\"tip\" type=\"fixed\"><parent link=\"link_6\"/>"
      "<child link=\"tool\"/><origin xyz=\"0 0 0.3\"/></joint>\n";
  text += part_link("left", "") + part_link("right", "");
  text += part_joint("finger", "prismatic", "tool", "left", "1 0 0");
  text +=
      part_joint("finger_2", "prismatic", "tool", "right", "-1 0 0", "<mimic joint=\"finger\"/>");
  return text + "</robot>\n";
}

const std::string kProblem = R"(format: stillbase.problem
version: 1
purpose: Parts.
robot:
  base: {mass: 200 kg, shape: {box: {size: [1, 1, 1]}}, orientation: {axis: [0, 1, 0], angle: 5 deg}}
  arms:
    - {file: arm.urdf, mount: {position: [0, 0, 0.5]}, hand: tool, hand_frame: {position: [0, 0, 0.1]}, prefix: r_}
  locked: {finger: 0.02 m}
  limits: {r_joint_4: {rate: 5 deg/s, torque: 12 N m}}
  start: [0, 0.5, 1, 0, 0.5, 0]
impact: {source: given, direction: [0, 0, -1]}
objective: base_angular_velocity
approach: {enabled: false}
)";

std::string problem_with(const std::string& from, const std::string& to) {
  std::string text = kProblem;
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("a spacecraft is put together in the problem file") {
  const Workshop shop;
  shop.write("arm.urdf", six_joint_arm());
  shop.write("problem.yaml", kProblem);
  const Outcome check = shop.run("check problem.yaml");
  INFO(check.err << check.out);
  REQUIRE(check.code == 0);
  for (const char* part :
       {"7 bodies", "6 joints", "216 kg", "r_joint_4", "5 deg/s, 12 N m", "homogeneous body",
        "arm.urdf:2: not-used: <gazebo>", "hand: r_hand_frame"}) {
    CHECK(check.out.find(part) != std::string::npos);
  }
  const Outcome plan = shop.run("plan problem.yaml -o plan.json --starts 8");
  INFO(plan.err);
  REQUIRE((plan.code == 0 || plan.code == 9));
  const Outcome again = shop.run("check plan.json");
  INFO(again.err);
  CHECK(again.code == 0);
  CHECK(again.out.find("arm.urdf:2: not-used: <gazebo>") != std::string::npos);
}

TEST_CASE("parts that do not fit are refused at their key") {
  const Workshop shop;
  shop.write("arm.urdf", six_joint_arm());
  const auto says = [&](const std::string& from, const std::string& to, const std::string& what) {
    shop.write("problem.yaml", problem_with(from, to));
    const Outcome outcome = shop.run("check problem.yaml");
    INFO(to << "\n" << outcome.err);
    CHECK(outcome.code == 3);
    CHECK(outcome.says(what));
  };
  says("{finger: 0.02 m}", "{thumb: 0}", "problem.yaml:8: unknown-name: robot.locked: thumb");
  says("{finger: 0.02 m}", "{finger_2: 0}", "lock that one instead");
  says("{finger: 0.02 m}", "{finger: 0.5 m}", "outside-limits");
  says("{finger: 0.02 m}", "{finger: 3 deg}", "robot.locked.finger");
  says("torque: 12 N m", "force: 12 N", "robot.limits: r_joint_4");
  says("hand: tool", "hand: claw", "robot.arms: there is no link 'claw'");
  says("mass: 200 kg, ", "", "robot.base.shape: belongs to a `mass`");
  says(", shape: {box: {size: [1, 1, 1]}}", "", "needs `inertia`, or a `shape`");
  says("    - {file: arm.urdf,", "    - {file: arm.urdf, prefix: r_}\n    - {file: arm.urdf,",
       "give this arm another `prefix`");
  shop.write("problem.yaml",
             problem_with("  arms:\n    - {file: arm.urdf, mount: {position: [0, 0, "
                          "0.5]}, hand: tool, hand_frame: {position: [0, 0, 0.1]}, "
                          "prefix: r_}\n  locked: {finger: 0.02 m}\n  limits: "
                          "{r_joint_4: {rate: 5 deg/s, torque: 12 N m}}\n",
                          "  file: robots/iiwa_on_cube.urdf\n"));
  const Outcome twice = shop.run("check problem.yaml");
  CHECK(twice.code == 3);
  CHECK(twice.says("robot.base: mass: the root link 'base' of the file has a mass of its own"));
}

TEST_CASE("from a robot file to a verified plan in three commands") {
  const Workshop shop;
  const std::string arm = "'" + source_path("problems/arms/seven_joint_arm.urdf") + "'";
  const Outcome made = shop.run("new problem.yaml --robot " + arm);
  INFO(made.err);
  REQUIRE(made.code == 0);
  CHECK(made.says("hand link: hand"));
  const Outcome check = shop.run("check problem.yaml");
  INFO(check.err << shop.text("problem.yaml"));
  REQUIRE(check.code == 0);
  const Outcome plan = shop.run("plan problem.yaml -o plan.json");
  INFO(plan.err);
  CHECK(plan.code == 0);
  const Outcome verify = shop.run("verify plan.json");
  INFO(verify.err << verify.out);
  CHECK(verify.code == 0);
  CHECK(shop.run("new problem.yaml --robot " + arm).code == 7);
  CHECK(shop.run("new other.yaml --robot " + arm + " --hand claw").code == 2);
  CHECK(shop.run("new other.yaml").code == 2);
  CHECK(shop.run("new other.json --robot " + arm).code == 2);
}

TEST_CASE("check names links that always touch") {
  const Workshop shop;
  shop.write("arm.urdf", six_joint_arm());
  const Outcome outcome = shop.run("check arm.urdf --suggest-contacts");
  CHECK(outcome.code == 0);
  CHECK(outcome.out.find("allowed_contacts") != std::string::npos);
}
