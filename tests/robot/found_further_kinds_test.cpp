// What further public files have: models of control libraries, exporters, hands with tendons,
// mobile arms. One small text per kind, written for this test, with where it was seen.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "robot/found_robot.hpp"

namespace stillbase {
namespace {

struct Found {
  std::string seen, text, rule;
  int joints;
  std::string head = "";
};

const std::string kRange = "<limit lower=\"-1\" upper=\"1\" effort=\"5\" velocity=\"1\"/>";

std::string found_joint(const std::string& name, const std::string& type, const std::string& parent,
                        const std::string& child, const std::string& inside = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + inside + "</joint>";
}

/// A link with mass behind the arm, on a joint of this type.
std::string moved(const std::string& type, const std::string& inside) {
  return "<link name=\"x\">BODY</link>" + found_joint("k", type, "arm", "x", inside);
}

/// A link without mass on the arm.
std::string held(const std::string& inside, const std::string& name = "x") {
  return "<link name=\"" + name + "\">" + inside + "</link>" +
         found_joint("f", "fixed", "arm", name);
}

std::string collision(const std::string& shape) {
  return "<collision><geometry>" + shape + "</geometry></collision>";
}

/// Slides along x and y and a turn about z, from `floor` to the base.
const std::string kPlanarBase =
    "<link name=\"floor\"/><link name=\"vx\"/><link name=\"vy\"/>" +
    found_joint("px", "prismatic", "floor", "vx", kRange) +
    found_joint("py", "prismatic", "vx", "vy", "<axis xyz=\"0 1 0\"/>" + kRange) +
    found_joint("pr", "continuous", "vy", "base", "<axis xyz=\"0 0 1\"/>");

/// All six freedoms, with a frame beside them.
std::string six_freedoms() {
  std::string text = "<link name=\"frame\"/>" + found_joint("ff", "fixed", "v0", "frame");
  for (int k = 0; k < 6; ++k) {
    const std::string from = "v" + std::to_string(k);
    const std::string to = k == 5 ? "base" : "v" + std::to_string(k + 1);
    text +=
        "<link name=\"" + from + "\"/>" +
        found_joint("q" + std::to_string(k), k < 3 ? "prismatic" : "revolute", from, to, kRange);
  }
  return text;
}

std::vector<Found> further_kinds() {
  return {
      {"pendulums on tendons of a simulator: ranges from above, for none",
       moved("revolute", "<limit effort=\"0\" lower=\"1\" upper=\"0\" velocity=\"50\"/>"),
       "joint-limits", 2},
      {"mobile arms: slides and turns between links without mass", kPlanarBase, "free-root", 1},
      {"templates of a modelling program: a base afloat by six joints", six_freedoms(), "free-root",
       1},
      {"exporters of a CAD service: wheels without mass and range",
       "<link name=\"x\"><inertial><mass value=\"0\"/><inertia ixx=\"0\" ixy=\"0\"  ixz=\"0\" "
       "iyy=\"0\" iyz=\"0\" izz=\"0\" /></inertial></link>" +
           found_joint("k", "revolute", "arm", "x", "<limit effort=\"1\" velocity=\"20\" />"),
       "idle-joint", 1},
      {"a control library: a planar joint in its own words",
       "<drake:joint name=\"p\" type=\"planar\"><parent link=\"world\"/><child "
       "link=\"base\"/></drake:joint>",
       "free-root", 1},
      {"a control library: accelerations of limits",
       moved("revolute",
             "<limit drake:acceleration=\"8.57\" effort=\"320\" lower=\"-2\" "
             "upper=\"2\" velocity=\"1.48\"/>"),
       "unknown-attribute", 2},
      {"hoppers of a course: a misspelt declaration", "", "", 1, "<?xml vertsion=\"1.0\"?>\n\n"},
      {"mobile arms of a course: a comment that begins twice", "", "", 1,
       "<?xml version=\"1.0\"?>\n<!-- ==== -->\n<!-- forked from\n<!-- ==== -->\n"},
      {"racks and pinions: a slide that follows a turn",
       "<link name=\"x\">BODY</link>" +
           found_joint(
               "k", "prismatic", "base", "x",
               "<axis xyz=\"0 -1.0 0\"/>" + kRange + "<mimic joint=\"j\" multiplier=\"0.105\"/>"),
       "", 1},
      {"hands with tendons: an inertial beside the links, cables, springs",
       "<parameter name=\"s\" value=\"1\"/><inertial><mass value=\"1.3\"/></inertial>"
       "<force_element name=\"e\"><torsional_spring stiffness=\"$s\"><joint "
       "name=\"j\"/></torsional_spring></force_element><cable name=\"c\" min_length=\"0.1\">"
       "<terminator link=\"arm\" xyz=\"0 0 0\"/></cable>",
       "unknown-element", 1},
      {"bipeds with springs: the inertia of a motor as a text",
       "<transmission name=\"t\"><joint name=\"j\"/><actuator><mechanicalReduction>25"
       "</mechanicalReduction><motorInertia>6.1e-05</motorInertia></actuator></transmission>",
       "not-used", 1},
      {"excavators: parentheses in names, twenty digits, e-72",
       "<link name=\"wheel_(1)\">BODY</link>" +
           found_joint("k", "continuous", "arm", "wheel_(1)",
                       "<origin xyz=\"-0.57399999999999995470 -1.2447660391936817316e-72 0\" "
                       "rpy=\"1.570796326794896558 -0 2.465e-32\"/>"),
       "", 2},
      {"hexapods: a mesh beside the geometry of a drawing",
       held("<visual><geometry><mesh filename=\"a.stl\"/></geometry><mesh "
            "filename=\"a.stl\"/></visual>"),
       "", 1},
      {"converters: elements of their own in every element, in letters of their own",
       held("<custom><japanese_text>\xe6\x96\x87</japanese_text></custom>"), "unknown-element", 1},
      {"converters: a colour without numbers, a texture",
       "<material name=\"black\"><color/></material><material name=\"t\"><texture "
       "filename=\"grid.png\"/></material>",
       "", 1},
      {"identified arms: sensors with a place on the links",
       "<sensor name=\"a\" type=\"gyroscope\"><parent link=\"arm\"/><origin xyz=\"0 -0.01 +0.01\" "
       "rpy=\"0 -0 0\"/></sensor>",
       "unknown-element", 1},
      {"optimized legs: attributes in any order, loops as pairs of frames",
       "<link  name=\"x\" >\n <inertial >\n  <inertia  ixy=\"0.0\"  iyy=\"1.1e-05\"  ixz=\"0.0\"  "
       "izz=\"1.1e-05\"  iyz=\"0.0\"  ixx=\"1.1e-05\" />\n  <mass  value=\"0.05\" />\n "
       "</inertial>\n</link>" +
           found_joint("f", "fixed", "arm", "x"),
       "", 1},
      {"folders of packages: a mesh by `find`",
       held(collision("<mesh filename=\"$(find robot)/meshes/a.stl\"/>") +
            collision("<mesh filename=\"file://$(find robot)/meshes/b.stl\"/>")),
       "mesh", 1},
      {"exporters under Windows: backslashes in the paths of meshes",
       held(collision("<mesh filename=\"package:\\\\robot\\meshes\\a.stl\"/>")), "mesh", 1},
      {"walking excavators: a simulator's block in a link, arrows in comments",
       held("<gazebo reference=\"x\"><gravity>true</gravity></gazebo>") +
           "<!--  <noise/> <!- change this -> \n <sensor name=\"${limb}\"/> -->",
       "unknown-element", 1},
      {"berths: the name of an assembly, a plate and handles on fixed joints",
       "<link name=\"Shell.SLDASM 1\"><inertial><mass value=\"0.35\"/><inertia "
       "ixx=\"0.00169054996882395\" ixy=\"4.84676140167788E-22\" ixz=\"-2.6E-20\" "
       "iyy=\"0.00337900278950978\" iyz=\"-7.4E-20\" "
       "izz=\"0.00169054996882395\"/></inertial></link>" +
           found_joint("f", "fixed", "arm", "Shell.SLDASM 1", "<axis\n xyz=\"0 0 1\" />"),
       "not-used", 1},
      {"drawings: a cylinder with a height",
       held(collision("<cylinder radius=\"1\" height=\"2\"/>")), "missing-attribute", 1},
  };
}

RobotModel read_found(const std::string& text, const std::string& hand = "arm",
                      const std::string& head = "") {
  return read_urdf(test::robot_of({"", head.c_str(), text.c_str(), "", 0}), "found.urdf", hand);
}

const Finding* remark_with(const RobotModel& robot, const std::string& part) {
  const auto found = std::find_if(
      robot.remarks.begin(), robot.remarks.end(),
      [&](const Finding& remark) { return to_string(remark).find(part) != std::string::npos; });
  return found == robot.remarks.end() ? nullptr : &*found;
}

}  // namespace

TEST_CASE("further kinds of files are read, with the remark that they deserve") {
  for (const Found& kind : further_kinds()) {
    INFO(kind.seen);
    RobotModel robot;
    REQUIRE_NOTHROW(robot = read_found(kind.text, "arm", kind.head));
    CHECK(robot.n() == kind.joints);
    std::string all;
    for (const Finding& remark : robot.remarks) all += to_string(remark) + "\n";
    INFO(all);
    CHECK(robot.remarks.empty() == kind.rule.empty());
    if (!kind.rule.empty()) CHECK(remark_with(robot, ": " + kind.rule + ": ") != nullptr);
  }
}

TEST_CASE("what stands for a floating base leaves the robot as it is without it") {
  const RobotModel plain = read_found("");
  for (const Found& kind : further_kinds()) {
    if (kind.rule != "free-root") continue;
    INFO(kind.seen);
    const RobotModel robot = read_found(kind.text);
    CHECK(robot.links.size() == plain.links.size());
    CHECK(robot.base.name == "base");
    CHECK(robot.base.mass == plain.base.mass);
    CHECK(robot.joints[0].name == "j");
    CHECK(robot.joints[0].p == plain.joints[0].p);
  }
  const RobotModel planar = read_found(kPlanarBase);
  const Finding* const said = remark_with(planar, "free-root");
  REQUIRE(said != nullptr);
  CHECK(said->message.find("above 'base' and the 3 joints between them") != std::string::npos);
}

TEST_CASE("links without mass that are no floating base are refused") {
  const auto refuses = [](const std::string& text) {
    INFO(text);
    CHECK_THROWS_WITH(read_found(text), Catch::Contains("the mass is 0 kg"));
  };
  // A shoulder of two turns, a gantry of two slides, slides beside which something else moves.
  refuses("<link name=\"v\"/><link name=\"w\"/>" + found_joint("a", "continuous", "v", "w") +
          found_joint("b", "revolute", "w", "base", kRange));
  refuses("<link name=\"v\"/><link name=\"w\"/>" + found_joint("a", "prismatic", "v", "w", kRange) +
          found_joint("b", "prismatic", "w", "base", kRange));
  refuses(kPlanarBase + "<link name=\"gate\">BODY</link>" +
          found_joint("g", "continuous", "floor", "gate"));
  // Without an arm behind them they are the robot.
  const std::string gantry =
      "<robot name=\"g\"><link name=\"floor\"/><link name=\"vx\"/><link name=\"vy\"/><link "
      "name=\"tool\">" +
      std::string(test::kInertialText) + "</link>" +
      found_joint("px", "prismatic", "floor", "vx", kRange) +
      found_joint("py", "prismatic", "vx", "vy", kRange) +
      found_joint("pz", "prismatic", "vy", "tool", kRange) + "</robot>";
  CHECK_THROWS_WITH(read_urdf(gantry, "g.urdf", "tool"), Catch::Contains("the mass is 0 kg"));
}

TEST_CASE("a range from above is read from below") {
  const auto joint = [](const std::string& limit) {
    const RobotModel robot =
        read_found(moved("revolute", "<limit " + limit + " effort=\"1\" velocity=\"1\"/>"));
    const Finding* const said = remark_with(robot, "lower is above upper");
    REQUIRE(said != nullptr);
    CHECK(said->message.find(": k") != std::string::npos);
    return robot.joints[1];
  };
  CHECK(joint("lower=\"1\" upper=\"-0.5\"").lower == -0.5);
  CHECK(joint("lower=\"1\" upper=\"-0.5\"").upper == 1);
  CHECK(joint("upper=\"-1.5\"").lower == -1.5);
  CHECK(joint("upper=\"-1.5\"").upper == 0);
}

TEST_CASE("limits, friction and shapes that are stated again are read once, or all of them") {
  const RobotModel robot = read_found(
      moved("revolute", kRange + "<limit effort=\"9\" velocity=\"7\" flags=\"x\"/><dynamics "
                                 "damping=\"1\"/><dynamics friction=\"2\"/>") +
      held(collision("<sphere radius=\"1\"/></geometry><geometry><box size=\"1 1 1\"/>"), "y"));
  CHECK(robot.joints[1].max_velocity == 1);
  CHECK(robot.joints[1].upper == 1);
  CHECK(robot.joints[1].viscous_friction == 1);
  CHECK(robot.joints[1].coulomb_friction == 0);
  CHECK(robot.shapes.size() == 2);
  CHECK(robot.remarks.size() == 3);
  for (const char* part : {"<joint> holds <limit> again: the first is read",
                           "<joint> holds <dynamics> again: the first is read",
                           "<collision> with several <geometry>: all are read"}) {
    INFO(part);
    CHECK(remark_with(robot, part) != nullptr);
  }
  CHECK_THROWS_WITH(read_found(moved("continuous", "<axis xyz=\"0 0 1\"/><axis xyz=\"0 1 0\"/>")),
                    Catch::Contains("more than one <axis>"));
}

TEST_CASE("a joint without range moves no mass, or is a joint") {
  const std::string still = "<limit lower=\"0.5\" upper=\"0.5\" effort=\"1\" velocity=\"1\"/>";
  const std::string tip =
      "<link name=\"x\"/><link name=\"y\"/>" +
      found_joint("k", "revolute", "arm", "x", "<axis xyz=\"0 0 1\"/>" + still) +
      found_joint("f", "fixed", "x", "y", "<origin xyz=\"1 0 0\"/>");
  const RobotModel robot = read_found(tip, "y");
  CHECK(robot.n() == 1);
  CHECK((robot.p_hand - Vector3d(std::cos(0.5), std::sin(0.5), 0)).norm() < 1e-15);
  REQUIRE(remark_with(robot, "idle-joint") != nullptr);
  CHECK(read_found(moved("revolute", still)).n() == 2);
  CHECK_THROWS_WITH(
      read_found("<link name=\"x\"/>" + found_joint("k", "revolute", "arm", "x", kRange)),
      Catch::Contains("the mass is 0 kg"));
}

TEST_CASE("values that are neither a mass nor a place are left out with a remark") {
  struct Value {
    std::string shape, said;
  };
  const std::vector<Value> shapes = {
      {"<sphere/>", "missing-attribute: <sphere> needs the attribute radius: left out"},
      {"<sphere radius=\"-1\"/>", "out-of-range: <sphere>: a size is negative: left out"},
      {"<sphere radius=\"1e999\"/>", "not-finite: <sphere> radius"},
      {"<box size=\"1\"/>", "not-a-vector: <box> size: '1' must be three numbers"},
      {"<box size=\"1 -1 1\"/>", "out-of-range: <box>: a size is negative"},
      {"<box size=\"1 1 nan\"/>", "not-finite: <box> size"},
      {"<cylinder radius=\"1\"/>", "missing-attribute: <cylinder> needs the attribute length"},
      {"<cylinder radius=\"0.1m\" length=\"1\"/>", "not-a-number: <cylinder> radius: '0.1m'"},
      {"<capsule radius=\"1\" length=\"-1\"/>", "out-of-range: <capsule>: a size is negative"},
      {"<mesh/>", "missing-attribute: <mesh> needs the attribute filename"},
      {"<mesh filename=\"a.stl\" scale=\"\"/>", "not-a-vector: <mesh> scale"},
  };
  for (const Value& value : shapes) {
    const RobotModel robot =
        read_found(held(collision(value.shape) + collision("<sphere radius=\"1\"/>")));
    INFO(value.shape << (robot.remarks.empty() ? "" : to_string(robot.remarks[0])));
    CHECK(robot.shapes.size() == 1);
    const Finding* const said = remark_with(robot, value.said);
    REQUIRE(said != nullptr);
    CHECK(said->line == 1);
  }
  const RobotModel robot =
      read_found(moved("revolute",
                       "<limit lower=\"-1\" upper=\"1\" velocity=\"nan\" effort=\"\"/><dynamics "
                       "damping=\"-0.1\" friction=\"none\"/>"));
  CHECK(robot.joints[1].max_velocity == 0);
  CHECK(robot.joints[1].max_effort == 0);
  CHECK(robot.joints[1].viscous_friction == 0);
  CHECK(robot.joints[1].coulomb_friction == 0);
  for (const char* part :
       {"velocity: 'nan' is not finite: left out", "effort: '' is not a number: left out",
        "damping: '-0.1' must not be negative: left out", "friction: 'none' is not a number",
        "no-rate-limit", "no-effort-limit"}) {
    INFO(part);
    CHECK(remark_with(robot, part) != nullptr);
  }
  CHECK_NOTHROW(read_found(moved("continuous",
                                 "<limit lower=\"\" upper=\"x\" effort=\"1\" "
                                 "velocity=\"1\"/>")));
  // What xacro has to expand is refused there, too.
  CHECK_THROWS_WITH(read_found(held(collision("<sphere radius=\"${r}\"/>"))),
                    Catch::Contains("xacro"));
}

TEST_CASE("joints of several freedoms are named so in the words of a control library, too") {
  for (const char* type : {"ball", "universal", "screw"}) {
    const std::string text = "<link name=\"x\">BODY</link><drake:joint name=\"k\" type=\"" +
                             std::string(type) +
                             "\"><parent link=\"arm\"/><child link=\"x\"/></drake:joint>";
    CHECK_THROWS_WITH(read_found(text), Catch::Contains("joint 'k' is '" + std::string(type)));
  }
}

TEST_CASE("paths of meshes in other words are read as those of packages") {
  for (const char* path :
       {"$(find arm_description)/meshes/a.stl", "file://$(find arm_description)/meshes/a.stl",
        "package:\\\\arm_description\\meshes\\a.stl", "package://arm_description\\meshes/a.stl"}) {
    INFO(path);
    const RobotModel robot =
        read_found(held(collision("<mesh filename=\"" + std::string(path) + "\"/>")));
    CHECK(remark_with(robot, "x (package://arm_description/meshes/a.stl)") != nullptr);
  }
}

}  // namespace stillbase
