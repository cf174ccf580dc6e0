// Spellings of robot files that are unusual and clear, and those that are no robot file yet.
#include <catch2/catch.hpp>

#include <stillbase/robot/urdf_reader.hpp>

#include "robot/mesh_shapes.hpp"
#include "robot/urdf_findings.hpp"
#include "robot/urdf_tree.hpp"

namespace stillbase {
namespace {

const std::string kInertial =
    "<inertial><mass value='2'/><inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' "
    "iyz='0'/></inertial>";

struct Text {
  std::string before, attributes = " name='r'", shape = "<sphere radius='0.1'/>",
                      limit = "lower='-1' upper='1' velocity='1' effort='1'", arm = "arm",
                      inertial = kInertial;

  std::string str() const {
    const std::string last = "<link name='last'>" + inertial + "</link><joint name='k' " +
                             "type='revolute'><parent link='" + arm +
                             "'/><child link='last'/><limit " + limit + "/></joint>";
    return before + "<robot" + attributes + "><link name='base'>" + kInertial +
           "</link><link name='" + arm + "'>" + inertial + "<collision><geometry>" + shape +
           "</geometry></collision></link><joint name='j' type='revolute'><parent link='base'/>" +
           "<child link='" + arm + "'/><limit " + limit + "/></joint>" + last + "</robot>";
  }
};

RobotModel read(const Text& text) { return read_urdf(text.str(), "r.urdf", "last"); }

std::string refusal(const std::string& text) {
  try {
    static_cast<void>(read_urdf(text, "r.urdf", "last"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string refusal(const Text& text) { return refusal(text.str()); }

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("what xacro has not expanded is refused by its name, wherever it stands") {
  Text link, number, mesh;
  link.arm = "${prefix}arm";
  number.limit = "lower='$(arg lower)' upper='1'";
  mesh.shape = "<mesh filename='$(arg folder)/arm.stl'/>";
  for (const Text& text : {link, number, mesh}) {
    CHECK(has(refusal(text), "macros (xacro) must be expanded first: `xacro "));
  }
  Text vector;
  vector.shape = "<box size='${a} ${b}'/>";
  CHECK(has(refusal(vector), "xacro"));
}

TEST_CASE("versions 1.1 and 1.2 and a document type that says no more than robot are read") {
  for (const char* version : {"1", "1.0", "1.1", "1.2"}) {
    Text text;
    text.attributes += std::string(" version='") + version + "'";
    CHECK(refusal(text).empty());
  }
  Text named;
  named.before = "<?xml version='1.0'?>\n<!DOCTYPE robot>\n";
  CHECK(refusal(named).empty());
  for (const char* more : {"robot SYSTEM 'a'", "robot[<!ENTITY a 'b'>]", "robot PUBLIC 'a' 'b'"}) {
    named.before = std::string("<!DOCTYPE ") + more + ">\n";
    CHECK(has(refusal(named), "doctype"));
  }
}

TEST_CASE("an infinite limit is none") {
  Text text;
  text.limit = "lower='-inf' upper='inf' velocity='Infinity' effort='inf'";
  const RobotModel robot = read(text);
  CHECK(robot.joints[0].type == JointType::Continuous);
  CHECK(robot.joints[0].max_velocity == kInfinity);
  CHECK(robot.joints[0].max_effort == kInfinity);
  text.limit = "lower='-1e999' upper='1e999' velocity='1e999' effort='1'";
  CHECK(read(text).joints[0].type == JointType::Continuous);
  CHECK(read(text).joints[0].max_velocity == kInfinity);
  text.limit = "lower='nan' upper='1' velocity='1' effort='1'";
  CHECK(has(refusal(text), "not finite"));
}

TEST_CASE("one number scales a mesh along all axes, and a remark says so") {
  Text text;
  text.shape = "<mesh filename='arm.stl' scale=' 0.001 '/>";
  urdf::Findings findings("r.urdf");
  const urdf::Tree tree = urdf::read_tree(text.str(), findings);
  REQUIRE(tree.links[1].meshes.size() == 1);
  CHECK(tree.links[1].meshes[0].scale == Vector3d::Constant(0.001));
  REQUIRE(findings.remarks().size() == 1);
  CHECK(findings.remarks()[0].rule == "scale");
  text.shape = "<mesh filename='arm.stl' scale='1 2'/>";
  urdf::Findings more("r.urdf");
  CHECK(urdf::read_tree(text.str(), more).links[1].meshes.empty());
  REQUIRE(more.remarks().size() == 1);
  CHECK(has(more.remarks()[0].message, "three numbers"));
}

TEST_CASE("hulls that the file gives are left by decompose, and a remark says so") {
  Text text;
  text.shape =
      "<mesh filename='arm.stl'/><hull vertices='0 0 0 1 0 0 0 1 0 0 0 1' faces='0 2 1 0 1 3 0 3 2 "
      "1 2 3'/>";
  for (const CollisionMeshes collision : {CollisionMeshes::Hull, CollisionMeshes::Decompose}) {
    urdf::Findings findings("r.urdf");
    urdf::Tree tree = urdf::read_tree(text.str(), findings);
    CHECK(urdf::enclose_meshes(tree, {"r.urdf", {}}, collision, findings));
    const std::vector<Finding> remarks = findings.remarks();
    REQUIRE(remarks.size() == (collision == CollisionMeshes::Decompose ? 1 : 0));
    if (!remarks.empty()) CHECK(has(remarks[0].message, "`decompose` leaves them: arm"));
  }
}

TEST_CASE("a file without masses is refused in one sentence") {
  Text text;
  text.inertial = "";
  const std::string said = refusal(text);
  CHECK(has(said, "no link that a joint moves has a mass"));
  CHECK_FALSE(has(said, "lock its joint"));
}

TEST_CASE("a file that is no robot says what it is") {
  CHECK(has(refusal("<sdf version='1.6'/>"), "must be <robot>, not 'sdf'"));
  CHECK(has(refusal("version https://git-lfs.github.com/spec/v1\noid sha256:0\n"), "git lfs pull"));
}

}  // namespace stillbase
