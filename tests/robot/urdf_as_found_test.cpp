// Files as vendors and exporters write them: what does not concern mechanics is remarked upon once
// per kind, what physics needs is refused.
#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/robot/urdf_reader.hpp>

using namespace stillbase;

namespace {

// Lines of this text are counted in the tests below.
const std::string kArmText = R"(<robot name="r">
<link name="base"><inertial>
<mass value="10"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
</inertial></link>
<link name="arm"><inertial>
<mass value="2"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>
</inertial>
<collision><geometry>
<box size="1 1 1"/>
</geometry></collision></link>
<joint name="j" type="revolute">
<parent link="base"/>
<child link="arm"/>
<axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="1" effort="1"/>
</joint>
</robot>
)";

std::string arm_with(const std::string& from, const std::string& to) {
  std::string text = kArmText;
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

std::string arm_and(const std::string& addition) {
  return arm_with("</robot>", addition + "</robot>");
}

RobotModel read_arm(const std::string& text) { return read_urdf(text, "r.urdf", "arm"); }

/// The remark of a rule whose message contains a text; an empty one when there is none.
Finding remark_of(const RobotModel& robot, const std::string& rule, const std::string& part = "") {
  const auto found =
      std::find_if(robot.remarks.begin(), robot.remarks.end(), [&](const Finding& f) {
        return f.rule == rule && f.message.find(part) != std::string::npos;
      });
  return found == robot.remarks.end() ? Finding{} : *found;
}

}  // namespace

TEST_CASE("a file that says nothing beyond mechanics has no remark") {
  CHECK(read_arm(kArmText).remarks.empty());
}

TEST_CASE("what is not read is remarked upon once per kind, with first line and count") {
  const RobotModel robot = read_arm(
      arm_and("<gazebo/>\n<gazebo reference=\"arm\"><x/></gazebo>\n<transmission name=\"t\"/>\n"
              "<ros2_control name=\"c\"/>\n<frobnicate a=\"1\"/>\n<material name=\"grey\"/>\n"));
  CHECK(robot.remarks.size() == 4);
  const Finding gazebo = remark_of(robot, "not-used", "<gazebo>");
  CHECK(gazebo.line == 19);
  CHECK(gazebo.file == "r.urdf");
  CHECK(gazebo.message.find("2 times") != std::string::npos);
  CHECK(remark_of(robot, "not-used", "<transmission>").line == 21);
  CHECK(remark_of(robot, "not-used", "<ros2_control>").line == 22);
  CHECK(remark_of(robot, "unknown-element", "'frobnicate' in <robot>").line == 23);
}

TEST_CASE("attributes and text that vendors add are remarked upon") {
  const RobotModel robot =
      read_arm(arm_with("<limit lower=\"-1\"", "stray<limit gear_velocity=\"10\" lower=\"-1\""));
  CHECK(remark_of(robot, "unknown-attribute", "gear_velocity").line == 17);
  CHECK(remark_of(robot, "unexpected-text", "stray").line == 17);
  CHECK(robot.joints[0].lower == -1);
}

TEST_CASE("axis, limit and dynamics of a fixed joint have no meaning and no effect") {
  const RobotModel robot = read_arm(arm_and(
      "<link name=\"flange\"/><joint name=\"f\" type=\"fixed\"><parent link=\"arm\"/>"
      "<child link=\"flange\"/><axis xyz=\"0 0 0\"/><limit effort=\"x\"/><dynamics/></joint>"));
  CHECK(robot.n() == 1);
  for (const char* name : {"<axis>", "<limit>", "<dynamics>"}) {
    CHECK(remark_of(robot, "not-used", name).line == 19);
  }
}

TEST_CASE("safety controllers are left out") {
  const RobotModel robot =
      read_arm(arm_with("<limit", "<safety_controller k_velocity=\"10\"/><limit"));
  CHECK(remark_of(robot, "not-used", "<safety_controller>").line == 17);
}

TEST_CASE("limits of zero are read and remarked upon with the joint") {
  RobotModel robot =
      read_arm(arm_with("velocity=\"1\" effort=\"1\"", "velocity=\"0\" effort=\"0\""));
  CHECK(remark_of(robot, "no-rate-limit", ": j").line == 17);
  CHECK(remark_of(robot, "no-effort-limit", ": j").line == 17);
  robot = read_arm(arm_with("velocity=\"1\" effort=\"1\"", ""));
  CHECK(robot.joints[0].max_velocity == 0);
  CHECK(remark_of(robot, "no-rate-limit").line == 17);
  robot = read_arm(arm_with("lower=\"-1\" ", ""));
  CHECK(robot.joints[0].lower == 0);
  CHECK(robot.joints[0].upper == 1);
  CHECK(remark_of(robot, "joint-limits").line == 17);
}

TEST_CASE("shapes: capsules are read, shapes without size and unknown ones are left out") {
  const std::string box = "<box size=\"1 1 1\"/>";
  RobotModel robot = read_arm(arm_with(box, "<capsule radius=\"0.1\" length=\"1\"/>"));
  REQUIRE(robot.shapes.size() == 1);
  CHECK(std::get<Capsule>(robot.shapes[0].geometry).length == 1);
  CHECK(robot.remarks.empty());
  for (const char* shape : {"<box size=\"0 0 0\"/>", "<sphere radius=\"0\"/>", "<teapot/>", ""}) {
    robot = read_arm(arm_with(box, shape));
    CHECK(robot.shapes.empty());
    CHECK(remark_of(robot, "no-shape").line > 0);
  }
  robot = read_arm(arm_with(box, "<mesh filename=\"package://a/b.stl\"/>"));
  CHECK(robot.shapes.empty());
  CHECK(remark_of(robot, "mesh", ": arm").line == 11);
}

TEST_CASE("a root that floats is the base's own freedom") {
  const std::string world =
      "<link name=\"world\"/><joint name=\"free\" type=\"floating\"><parent link=\"world\"/>"
      "<child link=\"base\"/></joint>";
  const RobotModel robot = read_arm(arm_and(world));
  CHECK(robot.n() == 1);
  CHECK(robot.base.name == "base");
  CHECK(find_link(robot, "world") == nullptr);
  CHECK(remark_of(robot, "free-root", "'world'").line == 19);
  CHECK_THROWS_AS(read_arm(arm_with("type=\"revolute\"", "type=\"floating\"")), InputError);
}

TEST_CASE("an arm that has yet to be mounted is read where that is enough") {
  const std::string world =
      "<link name=\"world\"/><joint name=\"w\" type=\"continuous\"><parent link=\"world\"/>"
      "<child link=\"base\"/></joint>";
  CHECK_THROWS_AS(read_arm(arm_and(world)), InputError);
  const RobotModel robot = read_urdf(arm_and(world), "r.urdf", "arm", {.may_lack_base = true});
  CHECK(robot.base.mass == 0);
  CHECK(robot.n() == 2);
  CHECK(remark_of(robot, "mass", "'world'").line == 19);
}

TEST_CASE("without a named hand the leaf behind the most joints is taken where that is enough") {
  const std::string camera =
      "<link name=\"camera\"/><joint name=\"c\" type=\"fixed\"><parent link=\"base\"/>"
      "<child link=\"camera\"/></joint>";
  CHECK_THROWS_AS(read_urdf(arm_and(camera), "r.urdf", ""), InputError);
  const RobotModel robot = read_urdf(arm_and(camera), "r.urdf", "", {.may_lack_hand = true});
  CHECK(robot.hand == "arm");
  CHECK(remark_of(robot, "hand-missing", "'arm'").message.find("camera") != std::string::npos);
}

TEST_CASE("remarks are not more than a page, whatever the file") {
  std::string many;
  for (int i = 0; i < 1000; ++i) many += "<x" + std::to_string(i) + "/>\n";
  const RobotModel robot = read_arm(arm_and(many));
  CHECK(robot.remarks.size() == 64);
  CHECK(robot.remarks.back().message.find("937 more") != std::string::npos);
}
