// Drives in robot files, in Drake's words, and in what is put together.
#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "robot/assembly.hpp"

using namespace stillbase;

namespace {

std::string heavy_link(const std::string& name) {
  return fmt::format(
      "<link name=\"{}\"><inertial><mass value=\"2\"/><inertia ixx=\"0.2\" iyy=\"0.3\" "
      "izz=\"0.25\" "
      "ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n",
      name);
}

std::string plain_joint(const std::string& name, const std::string& type, const std::string& parent,
                        const std::string& child, const std::string& more = "") {
  return fmt::format(
      "<joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/><origin xyz=\"0.1 0 "
      "0.3\"/><axis xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"5\"/>{}"
      "</joint>\n",
      name, type, parent, child, more);
}

std::string drive(const std::string& joint, const std::string& inside) {
  return fmt::format(
      "<transmission name=\"t\"><type>transmission_interface/SimpleTransmission</type><joint "
      "name=\"{}\"><hardwareInterface>x</hardwareInterface></joint><actuator name=\"m\">"
      "<mechanicalReduction>1</mechanicalReduction>{}</actuator></transmission>\n",
      joint, inside);
}

std::string rotor_and_gear(const std::string& rotor, const std::string& gear) {
  return fmt::format("<drake:rotor_inertia value=\"{}\"/><drake:gear_ratio value=\"{}\"/>", rotor,
                     gear);
}

/// A turning joint, one that follows it, a sliding one.
std::string driven_arm(const std::string& more) {
  return "<robot name=\"arm\" xmlns:drake=\"http://drake.mit.edu\">" + heavy_link("base") +
         heavy_link("upper") + heavy_link("lower") + heavy_link("hand") +
         plain_joint("shoulder", "revolute", "base", "upper") +
         plain_joint("elbow", "revolute", "upper", "lower",
                     "<mimic joint=\"shoulder\" multiplier=\"0.5\"/>") +
         plain_joint("slide", "prismatic", "lower", "hand") + more + "</robot>";
}

std::string refusal_of(const std::string& more) {
  try {
    (void)read_urdf(driven_arm(more), "arm.urdf", "hand");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a robot file has rotors and gears in the words of Drake") {
  const RobotModel robot =
      read_urdf(driven_arm(drive("shoulder", rotor_and_gear("2e-4", "-100")) +
                           drive("slide", "<drake:rotor_inertia value=\"3\"/>") +
                           drive("elbow", rotor_and_gear("1e-5", "50"))),
                "arm.urdf", "hand");
  REQUIRE(robot.n() == 2);
  CHECK(robot.joints[0].rotor_inertia == 2e-4);
  CHECK(robot.joints[0].gear_ratio == -100);
  CHECK(robot.joints[0].reflected_inertia() == Approx(2));
  CHECK(robot.joints[1].reflected_inertia() == 3);
  REQUIRE(robot.coupled_tree.size() == 3);
  CHECK(robot.coupled_tree[1].reflected_inertia() == Approx(0.025));
  CHECK(robot.remarks.empty());
}

TEST_CASE("a transmission without a rotor is remarked upon") {
  const RobotModel robot = read_urdf(driven_arm(drive("shoulder", "")), "arm.urdf", "hand");
  CHECK(robot.joints[0].reflected_inertia() == 0);
  REQUIRE(robot.remarks.size() == 1);
  CHECK(robot.remarks[0].rule == "not-used");
}

TEST_CASE("rotors that mean nothing are refused with their line") {
  CHECK(refusal_of(drive("wrist", rotor_and_gear("1", "1"))).find("there is no such joint") !=
        std::string::npos);
  CHECK_FALSE(refusal_of(drive("slide", rotor_and_gear("-1", "1"))).empty());
  CHECK_FALSE(refusal_of(drive("slide", rotor_and_gear("nan", "1"))).empty());
  CHECK_FALSE(refusal_of(drive("slide", rotor_and_gear("1", "inf"))).empty());
  CHECK_FALSE(refusal_of(drive("slide", "<drake:gear_ratio/>")).empty());
  CHECK(refusal_of(drive("slide", rotor_and_gear("1e60", "1e60"))).find("too large") !=
        std::string::npos);
  CHECK(refusal_of(drive("slide", rotor_and_gear("1", "1")) +
                   drive("slide", rotor_and_gear("1", "1")))
            .find("has a rotor already") != std::string::npos);
}

TEST_CASE("what was put together keeps its drives through its own text") {
  RobotAssembly assembly;
  assembly.add_robot(driven_arm(drive("slide", rotor_and_gear("3e-5", "400.1"))), {}, "arm.urdf");
  assembly.drive("shoulder", {1.0 / 3e4, 100.0 / 3});
  const std::string text = assembly.text();
  const RobotModel robot = read_urdf(text, "merged.urdf", "hand");
  CHECK(robot.joints[0].rotor_inertia == 1.0 / 3e4);
  CHECK(robot.joints[0].gear_ratio == 100.0 / 3);
  CHECK(robot.joints[1].rotor_inertia == 3e-5);
  CHECK(robot.joints[1].gear_ratio == 400.1);
  CHECK(robot.remarks.empty());

  RobotAssembly plain;
  plain.add_robot(driven_arm(""), {}, "arm.urdf");
  plain.limit("slide", {.lower = {}, .upper = {}, .rate = 2, .torque = {}, .force = {}});
  CHECK(plain.text().find("drake") == std::string::npos);
}

TEST_CASE("a locked joint drops its drive, a joint that is none has none") {
  RobotAssembly assembly;
  assembly.add_robot(driven_arm(""), {}, "arm.urdf");
  assembly.drive("slide", {1e-3, 10});
  assembly.lock("slide", 0.1);
  CHECK(assembly.text().find("drake") == std::string::npos);
  CHECK_THROWS_AS(assembly.drive("slide", {1e-3, 10}), AssemblyError);
  CHECK_THROWS_AS(assembly.drive("wrist", {1e-3, 10}), AssemblyError);
}
