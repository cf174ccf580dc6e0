// Spacecraft put together from a base and arms of files.
#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/reference/reference.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "robot/assembly.hpp"

using namespace stillbase;

namespace {

std::string arm_link(const std::string& name, double mass) {
  return fmt::format(
      "<link name=\"{}\"><inertial><origin xyz=\"0.02 0.01 0.2\" rpy=\"0.1 0.2 0.3\"/>"
      "<mass value=\"{}\"/><inertia ixx=\"0.02\" iyy=\"0.03\" izz=\"0.025\" ixy=\"0.001\" "
      "ixz=\"0.002\" iyz=\"-0.001\"/></inertial></link>",
      name, mass);
}

std::string arm_joint(const std::string& name, const std::string& type, const std::string& parent,
                      const std::string& child, const std::string& more) {
  return fmt::format(
      "<joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>"
      "<origin xyz=\"0.1 0.05 0.3\" rpy=\"0.4 1.5707963267948966 -0.2\"/><axis xyz=\"0 0.6 0.8\"/>"
      "<limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"5\"/>{}</joint>",
      name, type, parent, child, more);
}

/// Two turning joints and a gripper of two fingers, the second of which follows the first.
const std::string& arm_text() {
  static const std::string text =
      "<robot name=\"arm\"><link name=\"foot\"/>" + arm_link("upper", 3) + arm_link("lower", 2) +
      arm_link("left", 0.1) + arm_link("right", 0.1) +
      arm_joint("shoulder", "revolute", "foot", "upper", "") +
      arm_joint("elbow", "revolute", "upper", "lower", "") +
      arm_joint("grip", "prismatic", "lower", "left", "") +
      arm_joint("grip_2", "prismatic", "lower", "right",
                "<mimic joint=\"grip\" multiplier=\"-0.5\" offset=\"0.01\"/>") +
      "</robot>";
  return text;
}

BaseBody box_base() {
  BaseBody base;
  base.mass = 200;
  const Box box{{1, 0.8, 0.6}};
  base.inertia = homogeneous_inertia(base.mass, box);
  base.shapes.emplace_back(Pose{}, box);
  return base;
}

MountedArm mounted(const std::string& prefix) {
  MountedArm arm;
  arm.prefix = prefix;
  arm.mount = {Vector3d(0.5, 0.1, 0.2), rotation_exp(Vector3d(0.3, 0.2, 0.1))};
  arm.hand = "lower";
  arm.hand_frame = Pose{Vector3d(0, 0, 0.1), rotation_exp(Vector3d(0, 0.5, 0))};
  return arm;
}

RobotModel model_of(const RobotAssembly& assembly) {
  return read_urdf(assembly.text(), "merged.urdf", assembly.hand());
}

template <class Call>
std::string rule_of(Call call) {
  try {
    call();
  } catch (const AssemblyError& error) {
    return error.rule();
  }
  return "";
}

}  // namespace

TEST_CASE("a capsule is written as the cylinder that every reader of URDF knows") {
  BaseBody base = box_base();
  Pose beside;
  beside.position = {0, 0.1, 0};
  base.shapes = {{beside, Capsule{0.2, 0.5}}, {Pose{}, Cylinder{0.1, 0.3}}};
  RobotAssembly assembly;
  assembly.add_base("spacecraft", base);
  assembly.add_arm(arm_text(), {}, mounted("a_"));
  CHECK(assembly.text().find("<capsule") == std::string::npos);
  CHECK(assembly.text().find("Units: m, rad, kg") != std::string::npos);
  const RobotModel robot = model_of(assembly);
  REQUIRE(robot.shapes.size() == 2);
  const auto* const capsule = std::get_if<Capsule>(&robot.shapes[0].geometry);
  REQUIRE(capsule != nullptr);
  CHECK(capsule->radius == 0.2);
  CHECK(capsule->length == 0.5);
  CHECK(robot.shapes[0].pose.position == Vector3d(0, 0.1, 0));
  CHECK(std::holds_alternative<Cylinder>(robot.shapes[1].geometry));
}

TEST_CASE("an arm is mounted on a base, with its hand frame and prefix") {
  RobotAssembly assembly;
  assembly.add_base("craft", box_base());
  assembly.add_arm(arm_text(), {"arm.urdf", {}}, mounted("right_"));
  assembly.lock("grip", 0.04);
  const RobotModel robot = model_of(assembly);
  REQUIRE(robot.n() == 2);
  CHECK(robot.joints[0].name == "right_shoulder");
  CHECK(robot.base.name == "satellite");
  CHECK(robot.base.mass == 200);
  CHECK(robot.hand == "right_hand_frame");
  CHECK(robot.p_hand.isApprox(find_link(robot, "right_lower")->pose * Vector3d(0, 0, 0.1), 1e-14));
  CHECK(robot.total_mass() == Approx(205.2));
  CHECK(robot.bodies[1].mass == Approx(2.2));
  const Vector3d foot(0.5, 0.1, 0.2);
  CHECK(find_link(robot, "right_foot")->pose.position.isApprox(foot, 1e-14));
}

TEST_CASE("a locked joint and what follows it stand where the free ones would") {
  const std::string mount =
      "<link name=\"base\"><inertial><mass value=\"9\"/><inertia ixx=\"1\" "
      "iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>";
  std::string free = arm_text();
  const std::size_t mimic = free.find("<mimic");
  free.erase(mimic, free.find("/>", mimic) + 2 - mimic);
  const auto on_base = [&](std::string text) {
    const std::string foot = "<link name=\"foot\"/>";
    text.replace(text.find(foot), foot.size(), mount);
    for (std::size_t at; (at = text.find("\"foot\"")) != std::string::npos;) {
      text.replace(at, 6, "\"base\"");
    }
    return text;
  };
  const RobotModel open = read_urdf(on_base(free), "r.urdf", "right");
  RobotAssembly assembly;
  assembly.add_robot(on_base(arm_text()), {"r.urdf", {}}, "r.urdf");
  CHECK_FALSE(assembly.is_changed());
  assembly.lock("grip", 0.3);
  assembly.lock("elbow", -0.7);
  const RobotModel locked = read_urdf(assembly.text(), "r.urdf", "right");
  REQUIRE(locked.n() == 1);
  JointVectord all(4), one(1);
  all << 0.4, -0.7, 0.3, -0.5 * 0.3 + 0.01;
  one << 0.4;
  const auto a = reference::compute(open, {all, {}, {}});
  const auto b = reference::compute(locked, {one, {}, {}});
  CHECK(a.hand_position.isApprox(b.hand_position, 1e-13));
  CHECK(a.H.topLeftCorner(7, 7).isApprox(b.H, 1e-13));
}

TEST_CASE("a file may have a joint or link that is called as those of its mount") {
  std::string text = arm_text();
  for (const auto& [from, to] : {std::pair("name=\"elbow\"", "name=\"mount\""),
                                 std::pair("name=\"foot\"", "name=\"hand_frame\""),
                                 std::pair("parent link=\"foot\"", "parent link=\"hand_frame\"")}) {
    text.replace(text.find(from), std::string(from).size(), to);
  }
  RobotAssembly assembly;
  assembly.add_base("satellite", box_base());
  REQUIRE_NOTHROW(assembly.add_arm(text, {}, mounted("")));
  const RobotModel robot = model_of(assembly);
  CHECK(robot.hand != "hand_frame");
  CHECK(robot.joints[1].name == "mount");
}

TEST_CASE("two arms of one file share a base") {
  RobotAssembly assembly;
  assembly.add_base("craft", box_base());
  assembly.add_arm(arm_text(), {"arm.urdf", {}}, mounted("left_"));
  MountedArm second = mounted("right_");
  second.hand.clear();
  second.mount.position.y() = -0.1;
  assembly.add_arm(arm_text(), {"arm.urdf", {}}, second);
  CHECK(rule_of([&] { assembly.lock("grip", 0.0); }) == "unknown-name");
  assembly.lock("left_grip", 0.0);
  assembly.lock("right_grip", 0.0);
  assembly.lock("right_elbow", 0.5);
  assembly.limit("left_elbow", {.lower = {}, .upper = 0.5, .rate = 0.1, .torque = 12, .force = {}});
  const RobotModel robot = model_of(assembly);
  REQUIRE(robot.n() == 3);
  const Joint& elbow = robot.joints[find_joint(robot, "left_elbow")];
  CHECK(elbow.upper == 0.5);
  CHECK(elbow.lower == -1);
  CHECK(elbow.max_velocity == 0.1);
  CHECK(elbow.max_effort == 12);
  CHECK(robot.hand == "left_hand_frame");
  CHECK(assembly.joint_named("left_grip") == "left_grip");
}

TEST_CASE("the text of what was put together reads back to the same text and matrices") {
  RobotAssembly assembly;
  assembly.add_base("craft <&\">", box_base());
  assembly.add_arm(arm_text(), {"arm.urdf", {}}, mounted("r_"));
  assembly.lock("grip", 0.1);
  const RobotModel robot = model_of(assembly);
  RobotAssembly again;
  again.add_robot(assembly.text(), {"merged.urdf", {}}, "merged.urdf");
  const RobotModel copy = read_urdf(again.text(), "again.urdf", assembly.hand());
  Random random(3);
  for (int i = 0; i < 10; ++i) {
    JointVectord phi(robot.n());
    for (int k = 0; k < robot.n(); ++k) phi[k] = random.uniform(-1, 1);
    const auto a = reference::compute(robot, {phi, {}, {}});
    const auto b = reference::compute(copy, {phi, {}, {}});
    CHECK(a.H.isApprox(b.H, 1e-13));
    CHECK(a.hand_position.isApprox(b.hand_position, 1e-13));
    CHECK(a.hand_rotation.isApprox(b.hand_rotation, 1e-13));
  }
}

TEST_CASE("parts that do not fit are refused with the reason") {
  RobotAssembly assembly;
  assembly.add_base("craft", box_base());
  MountedArm arm = mounted("");
  arm.hand = "claw";
  CHECK(rule_of([&] { assembly.add_arm(arm_text(), {"a.urdf", {}}, arm); }) == "hand-unknown");
  assembly.add_arm(arm_text(), {"a.urdf", {}}, mounted(""));
  CHECK(rule_of([&] {
          assembly.add_arm(arm_text(), {"a.urdf", {}}, mounted(""));
        }) == "duplicate-name");
  CHECK(rule_of([&] { assembly.lock("wrist", 0.0); }) == "unknown-name");
  CHECK(rule_of([&] { assembly.lock("grip_2", 0.0); }) == "not-used");
  CHECK(rule_of([&] { assembly.lock("elbow", 1.5); }) == "outside-limits");
  CHECK(rule_of([&] { assembly.lock("mount", 0.0); }) == "not-used");
  CHECK(rule_of([&] {
          assembly.limit("elbow",
                         {.lower = 2.0, .upper = {}, .rate = {}, .torque = {}, .force = {}});
        }) == "out-of-range");
  RobotAssembly file;
  file.add_robot("<robot name=\"r\">" + arm_link("root", 3) + "</robot>", {"r.urdf", {}}, "r.urdf");
  CHECK(rule_of([&] { file.load_root(box_base()); }) == "contradiction");
}

TEST_CASE("couplings: chains are followed, circles and missing masters are refused") {
  const auto text = [](const std::string& a, const std::string& b) {
    return "<robot name=\"r\">" + arm_link("base", 9) + arm_link("x", 1) + arm_link("y", 1) +
           arm_link("z", 1) + arm_joint("jx", "revolute", "base", "x", "") +
           arm_joint("jy", "revolute", "base", "y", a) +
           arm_joint("jz", "revolute", "base", "z", b) + "</robot>";
  };
  const auto rule = [&](const std::string& a, const std::string& b) -> std::string {
    try {
      RobotAssembly().add_robot(text(a, b), {"r.urdf", {}}, "r.urdf");
    } catch (const InputError& error) {
      return error.findings().front().rule;
    }
    return "";
  };
  RobotAssembly chain;
  chain.add_robot(text("<mimic joint=\"jx\" multiplier=\"2\" offset=\"1\"/>",
                       "<mimic joint=\"jy\" multiplier=\"3\" offset=\"0.5\"/>"),
                  {"r.urdf", {}}, "r.urdf");
  REQUIRE(chain.joints()[2].mimic);
  CHECK(chain.joints()[2].mimic->master == "jx");
  CHECK(chain.joints()[2].mimic->ratio == 6);
  CHECK(chain.joints()[2].mimic->offset == 3.5);
  CHECK(rule("<mimic joint=\"none\"/>", "") == "mimic");
  CHECK(rule("<mimic joint=\"jy\"/>", "") == "mimic");
  CHECK(rule("<mimic joint=\"jz\"/>", "<mimic joint=\"jy\"/>") == "mimic");
}

TEST_CASE("homogeneous bodies have the inertia of their integrals") {
  const Matrix3d box = homogeneous_inertia(12, Box{{1, 2, 3}});
  CHECK(box.diagonal().isApprox(Vector3d(13, 10, 5), 1e-15));
  const double r = 0.3, l = 0.8;
  CHECK(homogeneous_inertia(5, Sphere{r})(0, 0) == Approx(0.4 * 5 * r * r));
  // The capsule by slices along its axis.
  const int slices = 400000;
  double volume = 0, about_z = 0, about_x = 0;
  for (int i = 0; i < slices; ++i) {
    const double z = (i + 0.5) / slices * (l / 2 + r);
    const double beyond = std::max(0.0, z - l / 2);
    const double q = r * r - beyond * beyond;
    volume += q;
    about_z += q * q / 2;
    about_x += q * (q / 4 + z * z);
  }
  const Matrix3d capsule = homogeneous_inertia(7, Capsule{r, l});
  CHECK(capsule(2, 2) == Approx(7 * about_z / volume).epsilon(1e-6));
  CHECK(capsule(0, 0) == Approx(7 * about_x / volume).epsilon(1e-6));
}

TEST_CASE("of many joints those that are locked do not count") {
  constexpr int kJoints = 100, kLocked = 95;
  std::string text = "<robot name=\"many\">" + arm_link("link_0", 1);
  for (int k = 1; k <= kJoints; ++k) {
    const std::string parent = fmt::format("link_{}", k - 1), child = fmt::format("link_{}", k);
    text +=
        arm_link(child, 1) + arm_joint(fmt::format("joint_{}", k), "revolute", parent, child, "");
  }
  RobotAssembly assembly;
  assembly.add_robot(text + "</robot>", {}, "many.urdf");
  for (int k = 1; k <= kLocked; ++k) assembly.lock(fmt::format("joint_{}", k), 0.1);
  const RobotModel robot = read_urdf(assembly.text(), "", "");
  CHECK(robot.n() == kJoints - kLocked);
  CHECK(robot.total_mass() == Approx(kJoints + 1));
}
