// Which hand a first problem takes, where it points, and how large the base is.
#include <catch2/catch.hpp>

#include "cli/arm_text.hpp"
#include "cli/tool.hpp"

namespace stillbase::cli_test {
namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

constexpr const char* kCapsule = "<capsule radius=\"0.05\" length=\"0.18\"/>";

/// A box of 9 kg with two joints and two fingers beyond them, whose frames are at their joints.
std::string free_flyer() {
  const auto part = [](const std::string& name, const std::string& mass, const std::string& size,
                       const std::string& origin) {
    return "<link name=\"" + name + "\"><inertial><mass value=\"" + mass +
           "\"/><inertia ixx=\"0.02\" iyy=\"0.02\" izz=\"0.02\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>"
           "</inertial><collision><origin xyz=\"" +
           origin + "\"/><geometry><box size=\"" + size + "\"/></geometry></collision></link>\n";
  };
  const auto joint = [](const std::string& name, const std::string& parent,
                        const std::string& child, const std::string& origin,
                        const std::string& axis) {
    return "<joint name=\"" + name + "\" type=\"revolute\"><parent link=\"" + parent +
           "\"/><child link=\"" + child + "\"/><origin xyz=\"" + origin + "\"/><axis xyz=\"" +
           axis +
           "\"/><limit lower=\"-1.5\" upper=\"1.5\" velocity=\"0.12\" effort=\"1\"/></joint>\n";
  };
  return part("body", "9", "0.3 0.3 0.3", "0 0 0") +
         part("near", "0.16", "0.12 0.07 0.04", "-0.05 0 0") +
         part("far", "0.1", "0.075 0.07 0.087", "0 0 -0.02") +
         part("left", "0.04", "0.07 0.02 0.025", "-0.025 0 0") +
         part("right", "0.04", "0.07 0.02 0.025", "-0.025 0 0") +
         joint("near_joint", "body", "near", "-0.22 0 -0.1", "0 -1 0") +
         joint("far_joint", "near", "far", "-0.1 0 0", "0 0 1") +
         joint("left_finger_joint", "far", "left", "-0.06 -0.02 -0.05", "0 0 1") +
         joint("right_finger_joint", "far", "right", "-0.06 0.02 -0.05", "0 0 1");
}

}  // namespace

TEST_CASE("a single jaw is no part of the arm") {
  const Workshop shop;
  shop.write("jaw.urdf", robot_text(arm_chain("zyyzy", kCapsule) + part_link("clamp", "") +
                                    part_joint("gripper", "revolute", "tool", "clamp", "1 0 0")));
  const Outcome made = shop.run("new problem.yaml --robot jaw.urdf");
  INFO(made.err);
  REQUIRE(made.code == 0);
  CHECK(made.says("hand link: tool"));
  const std::string text = shop.text("problem.yaml");
  CHECK(text.find("    gripper: 0\n") != std::string::npos);  // among those that are locked
}

TEST_CASE("joints of a wrist are no fingers, whatever they carry") {
  const Workshop shop;
  shop.write("wrist.urdf", robot_text(replaced(arm_chain("zyyzyz", kCapsule), "\"joint_6\"",
                                               "\"gripper_roll\"")));
  const Outcome made = shop.run("new problem.yaml --robot wrist.urdf");
  INFO(made.err);
  REQUIRE(made.code == 0);
  CHECK(shop.text("problem.yaml").find("locked:") == std::string::npos);
}

TEST_CASE("a hand at its joint points away from the joint before, wherever the mass is") {
  const Workshop shop;
  // The frame of a flange stands where its link ends: the mass is behind it.
  std::string text = arm_chain("zyyzyz", "", "0");
  const std::string ahead = "xyz=\"0 0 0.15\"", behind = "xyz=\"0 0 -0.02\"";
  text.replace(text.rfind(ahead), ahead.size(), behind);
  shop.write("flange.urdf", robot_text(text));
  const Outcome made = shop.run("new problem.yaml --robot flange.urdf");
  INFO(made.err);
  REQUIRE(made.code == 0);
  CHECK(shop.text("problem.yaml").find("approach_axis: [0, 0, 1]") != std::string::npos);
}

TEST_CASE("a free-flyer of two joints goes from its file to a verified plan with a fingertip") {
  const Workshop shop;
  shop.write("free_flyer.urdf", robot_text(free_flyer()));
  const Outcome made = shop.run("new problem.yaml --robot free_flyer.urdf");
  INFO(made.err);
  REQUIRE(made.code == 0);
  CHECK(made.says("base: the file's own, 9 kg"));
  CHECK(made.says("hand link: left"));
  CHECK(shop.text("problem.yaml").find("right_finger_joint: 0") != std::string::npos);
  const Outcome plan = shop.run("plan problem.yaml -o plan.json");
  INFO(plan.err);
  CHECK(plan.code == 0);
  const Outcome verified = shop.run("verify plan.json");
  INFO(verified.err);
  CHECK(verified.code == 0);
}

TEST_CASE("the base of a first problem is ten times as heavy as a light arm, and 10 kg at least") {
  const Workshop shop;
  const std::string arm = arm_chain("zyyzyz", kCapsule);
  const auto base_of = [&](const std::string& mass) {
    shop.write("arm.urdf",
               robot_text(replaced(arm, "<mass value=\"2\"/>", "<mass value=\"" + mass + "\"/>")));
    const Outcome made = shop.run("new " + mass + ".yaml --robot arm.urdf");
    INFO(made.err);
    CHECK(made.code == 0);
    return made.err + made.out;
  };
  CHECK(base_of("0.5").find("base: 30 kg") != std::string::npos);
  CHECK(base_of("0.05").find("base: 10 kg") != std::string::npos);
}

TEST_CASE("boxes that part an arm's postures may overlap where one body is between them") {
  const Workshop shop;
  // At bends of about 45 deg the second next boxes touch: upright and folded postures are no path
  // apart.
  shop.write("boxes.urdf", robot_text(arm_chain("zyzyzyz", "<box size=\"0.33 0.33 0.5\"/>")));
  shop.write("slim.urdf", robot_text(arm_chain("zyzyzyz", "<box size=\"0.26 0.26 0.4\"/>")));
  const Outcome made = shop.run("new boxes.yaml --robot boxes.urdf");
  INFO(made.err);
  REQUIRE(made.code == 0);
  CHECK(made.says("allowed contacts: links closer than 0.02 m in at least 50 % of all postures"));
  CHECK(shop.text("boxes.yaml").find("allowed_contacts: [[link_1, link_3], [link_2, link_4]") !=
        std::string::npos);
  REQUIRE(shop.run("new slim.yaml --robot slim.urdf").code == 0);
  CHECK(shop.text("slim.yaml").find("allowed_contacts") == std::string::npos);
}

TEST_CASE("an arm on a heavy table stands on a base where its tool lies inside of its shapes") {
  const std::string table =
      "<link name=\"foot\"><inertial><mass value=\"200\"/><inertia ixx=\"30\" iyy=\"30\" "
      "izz=\"50\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial><collision><origin xyz=\"0 0 "
      "-0.05\"/><geometry><box size=\"1 1 0.1\"/></geometry></collision></link>";
  const std::string rod = "<cylinder radius=\"0.06\" length=\"0.3\"/>";
  const Workshop shop;
  for (const std::string tool : {"0.3", "0"}) {  // at the end of the rod, at its joint
    shop.write("arm.urdf", robot_text(replaced(arm_chain("zyyzyz", rod, tool),
                                               "<link name=\"foot\"/>", table)));
    const Outcome made = shop.run("new problem.yaml --force --robot arm.urdf");
    INFO(made.err);
    REQUIRE(made.code == 0);
    CHECK(made.says("base: the file's own, 200 kg") == (tool == "0.3"));
    CHECK(made.says("the file's own base stands on it") == (tool == "0"));
  }
}

TEST_CASE("a first problem keeps more solutions, most of arms with meshes") {
  const Workshop shop;
  std::filesystem::copy(source_path("problems/arms/meshes/six_joint_upper.obj"),
                        shop.path("link.obj"));
  shop.write("shapes.urdf", robot_text(arm_chain("zyyzyz", kCapsule)));
  shop.write("meshes.urdf", robot_text(arm_chain("zyyzyz", "<mesh filename=\"link.obj\"/>")));
  for (const std::string name : {"shapes", "meshes"}) {
    const Outcome made = shop.run("new " + name + ".yaml --robot " + name + ".urdf");
    INFO(made.err);
    REQUIRE(made.code == 0);
    const std::string kept = name == "meshes" ? "max_candidates: 128" : "max_candidates: 64";
    CHECK(shop.text(name + ".yaml").find(kept) != std::string::npos);
  }
}

}  // namespace stillbase::cli_test
