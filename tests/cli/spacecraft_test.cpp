// Spacecraft that a problem puts together.
#include <catch2/catch.hpp>

#include "cli/arm_text.hpp"
#include "cli/tool.hpp"

using namespace stillbase::cli_test;

namespace {

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

TEST_CASE("arms that are mounted into one another are refused") {
  const Workshop shop;
  shop.write("arm.urdf", six_joint_arm());
  const auto second_at = [&](const std::string& place) {
    std::string text = problem_with(
        "  locked: {finger: 0.02 m}",
        "    - {file: arm.urdf, mount: {position: " + place +
            "}, prefix: l_}\n  locked: {r_finger: 0, l_finger: 0, l_joint_1: 0, l_joint_2: 0, "
            "l_joint_3: 0, l_joint_4: 0, l_joint_5: 0, l_joint_6: 0}");
    shop.write("problem.yaml", text);
  };
  second_at("[0, 0.4, 0.5]");
  const Outcome beside = shop.run("check problem.yaml");
  INFO(beside.err);
  CHECK(beside.code == 0);
  second_at("[0, 0.05, 0.5]");
  for (const std::string command : {"check problem.yaml", "plan problem.yaml -o plan.json"}) {
    const Outcome inside = shop.run(command);
    INFO(command << inside.err);
    CHECK(inside.code == 3);
    CHECK(inside.says("problem.yaml:6: mounts-overlap: robot.arms: "));
    CHECK(inside.says("move a `mount`"));
  }
}

TEST_CASE("an arm that is mounted inside the satellite is refused") {
  const Workshop shop;
  shop.write("arm.urdf", six_joint_arm());
  const auto check_at = [&](const std::string& z) {
    shop.write("problem.yaml", problem_with("[0, 0, 0.5]", "[0, 0, " + z + "]"));
    return shop.run("check problem.yaml");
  };
  CHECK(check_at("0.5").code == 0);
  const Outcome sunk = check_at("-0.2");
  INFO(sunk.err);
  CHECK(sunk.code == 3);
  CHECK(sunk.says("problem.yaml:6: mount-inside: robot.arms: r_"));
  CHECK(sunk.says(" with satellite: the middle of the link is inside the satellite"));
}

TEST_CASE("locked links that stand in what they are merged with are refused") {
  const Workshop shop;
  std::string text = file_text(source_path("problems/mounted_two_arms.yaml"));
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
      text.replace(at, from.size(), to);
    }
  };
  replace("file: arms/", "file: " + source_path("problems/arms/"));
  // The forearm then reaches through the satellite's wall.
  const std::size_t at = text.find("    left_shoulder_pan:");
  const std::size_t end = text.find("  start:");
  text.replace(at, end - at,
               "    left_shoulder_pan: 0\n    left_shoulder_lift: 80 deg\n"
               "    left_elbow: 60 deg\n    left_wrist_1: 40 deg\n    left_wrist_2: 0\n"
               "    left_wrist_3: 0\n");
  shop.write("problem.yaml", text);
  for (const std::string command : {"check problem.yaml", "plan problem.yaml -o plan.json"}) {
    const Outcome inside = shop.run(command);
    INFO(command << inside.err);
    CHECK(inside.code == 3);
    CHECK(inside.says(": locked-overlap: robot.locked: left_"));
    CHECK(inside.says(" with satellite overlap where the joints are locked"));
  }
  replace("  start:",
          "  allowed_contacts: [[left_upper_arm, satellite], [left_forearm, satellite], "
          "[left_wrist_1, satellite], [left_wrist_2, satellite], [left_wrist_3, satellite]]\n"
          "  start:");
  shop.write("problem.yaml", text);
  const Outcome allowed = shop.run("check problem.yaml");
  INFO(allowed.err);
  CHECK(allowed.code == 0);
}

TEST_CASE("locked joints do not count, and what they hold is still looked at") {
  const auto link = [](const std::string& name, double mass, const std::string& shape) {
    return "<link name=\"" + name + "\"><inertial><mass value=\"" + std::to_string(mass) +
           "\"/><inertia ixx=\"0.02\" iyy=\"0.02\" izz=\"0.02\" ixy=\"0\" ixz=\"0\" "
           "iyz=\"0\"/></inertial><collision><geometry><" +
           shape + "/></geometry></collision></link>\n";
  };
  std::string robot = "<robot name=\"many\">" + link("body", 200, "box size=\"1 1 1\"");
  const auto chain = [&](const std::string& name, int count, const char* first, const char* next) {
    for (int k = 0; k < count; ++k) {
      const std::string number = std::to_string(k);
      const std::string parent = k == 0 ? "body" : name + std::to_string(k - 1);
      robot += link(name + number, 0.1, "sphere radius=\"0.01\"");
      robot += "<joint name=\"" + name + "joint_" + number +
               "\" type=\"revolute\"><parent link=\"" + parent + "\"/><child link=\"" + name +
               number + "\"/><origin xyz=\"" + (k == 0 ? first : next) +
               "\"/><axis xyz=\"1 0 0\"/><limit lower=\"-3\" upper=\"3\" velocity=\"1\" "
               "effort=\"5\"/></joint>\n";
    }
  };
  chain("arm_", 5, "0.7 0 0", "0 0 0.1");
  chain("tail_", 95, "0 0.7 0", "0 0.03 0");
  const Workshop shop;
  shop.write("many.urdf", robot + "</robot>");
  const auto check = [&](const std::string& bend) {
    std::string locked = "tail_joint_0: 0";
    for (int k = 1; k < 95; ++k) {
      locked += ", tail_joint_" + std::to_string(k) + ": " + (k == 1 ? bend : "0");
    }
    shop.write("problem.yaml",
               "format: stillbase.problem\nversion: 1\npurpose: Many joints.\nrobot:\n"
               "  file: many.urdf\n  hand: arm_4\n  locked: {" +
                   locked +
                   "}\n  start: [0, 0.5, 0.5, 0.5, 0.5]\n"
                   "impact: {source: given, direction: [0, 0, -1]}\n"
                   "objective: base_angular_velocity\napproach: {enabled: false}\n");
    return shop.run("check problem.yaml");
  };
  const Outcome straight = check("0");
  INFO(straight.err);
  CHECK(straight.code == 0);
  CHECK(straight.out.find("5 joints") != std::string::npos);
  const Outcome folded = check("3");  // back through the body
  INFO(folded.err);
  CHECK(folded.code == 3);
  CHECK(folded.says("locked-overlap: robot.locked: tail_"));
}

TEST_CASE("check names links that always touch") {
  const Workshop shop;
  shop.write("arm.urdf", six_joint_arm());
  const Outcome outcome = shop.run("check arm.urdf --suggest-contacts");
  CHECK(outcome.code == 0);
  CHECK(outcome.out.find("allowed_contacts") != std::string::npos);
}
