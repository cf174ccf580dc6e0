// More of what public robot files have: arms, grippers, humanoids, vessels, toys of simulators. One
// small text per kind, written for this test. All are read; each says what has to be remarked upon.
#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "robot/assembly.hpp"
#include "robot/found_robot.hpp"

namespace stillbase {
namespace {

using test::Kind;
using test::robot_of;

/// Behind `arm`: a fixed link that holds `inside`.
#define ON_ARM(inside)                                                        \
  "<link name=\"x\">" inside                                                  \
  "</link><joint name=\"f\" type=\"fixed\"><parent link=\"arm\"/><child link" \
  "=\"x\"/></joint>"
/// Behind `arm`: a massive link on a joint of a type that holds `inside`.
#define JOINT(type, inside)                                    \
  "<link name=\"x\">BODY</link><joint name=\"k\" type=\"" type \
  "\"><parent link=\"arm"                                      \
  "\"/><child link=\"x\"/>" inside "</joint>"
#define SHAPE(inside) ON_ARM("<collision><geometry>" inside "</geometry></collision>")
#define PLACED(name, type, parent, child)                                                        \
  "<joint name=\"" name "\" type=\"" type "\"><parent link=\"" parent "\"/><child link=\"" child \
  "\"/></joint>"

const std::vector<Kind>& more_kinds() {
  static const std::vector<Kind> all = {
      {"pendulums of a control library: a world that is not stated", "",
       PLACED("w", "fixed", "world", "base"), "implied-world", 1},
      {"vehicles of a control library: afloat in a world that is not stated", "",
       PLACED("w", "floating", "world", "base"), "implied-world", 1},
      {"mobile arms: a planar joint below frames of the floor", "",
       "<link name=\"map\"/><link name=\"odom\"/><link name=\"dock\"/>" PLACED(
           "m", "fixed", "map", "odom") PLACED("d", "fixed", "map", "dock")
           PLACED("p", "planar", "odom", "base"),
       "free-root", 1},
      {"service robots: a planar root with a massless inertial", "",
       "<link name=\"odom\"><inertial><mass value=\"0\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" "
       "iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link>" PLACED("p", "planar", "odom", "base"),
       "free-root", 1},
      {"tutorials: a world that no joint names", "", "<link name=\"world\"/>", "lone-link", 1},
      {"expanded by hand: definitions of macros that are left over", "",
       "<xacro:property name=\"pi\" value=\"3.14\"/><xacro:arg name=\"a\" default=\"\"/>"
       "<xacro:macro name=\"m\" params=\"p\"><link name=\"${p}\"/></xacro:macro>",
       "not-used", 1},
      {"editors: processing instructions",
       "<?xml version=\"1.0\"?>\n<!-- by -->\n<?xml-model a?>\n", "<?keep this?>", "", 1},
      {"old exporters: a declaration below a comment", "<!-- by -->\n<?xml version=\"1.0\"?>\n", "",
       "", 1},
      {"merged by hand: the same origin twice", "",
       JOINT("continuous", "<origin xyz=\"0 0 1\"/><origin xyz=\"0 0 1\"/>"), "repeated-element",
       2},
      {"converted from simulators: limits of -1", "",
       JOINT("revolute", "<limit lower=\"-1\" upper=\"1\" effort=\"-1.0\" velocity=\"-1.0\"/>"),
       "negative-limit", 2},
      {"hobby arms: a tensor by its diagonal", "",
       "<link name=\"x\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/>"
       "</inertial></link><joint name=\"k\" type=\"continuous\"><parent link=\"arm\"/><child "
       "link=\"x\"/></joint>",
       "inertia", 2},
      {"sensors: a mass without a tensor", "", ON_ARM("<inertial><mass value=\"0.1\"/></inertial>"),
       "missing-element", 1},
      {"frames: an inertial without a mass", "",
       ON_ARM("<inertial><origin xyz=\"0 0 0\"/></inertial>"), "missing-element", 1},
      {"grippers: a plate whose three digits break the triangle inequality", "",
       "<link name=\"x\"><inertial><mass value=\"0.1\"/><inertia ixx=\"0.00124\" ixy=\"0\" "
       "ixz=\"0\" iyy=\"0.00131\" iyz=\"0\" izz=\"0.00256\"/></inertial></link><joint name=\"k\" "
       "type=\"continuous\"><parent link=\"arm\"/><child link=\"x\"/></joint>",
       "inertia", 2},
      {"hands: a number that is below all that a double holds", "",
       ON_ARM("<inertial><origin xyz=\"1e-400 0 0\"/><mass value=\"1\"/><inertia ixx=\"1\" "
              "ixy=\"-1E-330\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>"),
       "", 1},
      {"collections: a mesh and its box in one geometry", "",
       SHAPE("<mesh filename=\"a.stl\"/><box size=\"1 1 1\"/>"), "geometry", 1},
      {"exporters: a mesh of no file", "", SHAPE("<mesh filename=\"\"/>"), "no-shape", 1},
      {"pages: a mesh of the net", "", SHAPE("<mesh filename=\"https://host/a.stl\"/>"), "mesh", 1},
      {"exporters: a package without a file", "", SHAPE("<mesh filename=\"package://arm\"/>"),
       "mesh", 1},
      {"converted from simulators: a capsule without length", "",
       SHAPE("<capsule radius=\"0.1\" length=\"0\"/>"), "", 1},
      {"grounds: a plane", "", SHAPE("<plane normal=\"0 0 1\"/>"), "no-shape", 1},
      {"toys: deformable bodies", "",
       "<deformable name=\"d\"><inertial><mass value=\"1\"/></inertial><neohookean mu=\"60\"/>"
       "</deformable>",
       "unknown-element", 1},
      {"toys: data of the user in links and shapes", "",
       ON_ARM("<bullet><user-data key=\"a\">text</user-data></bullet>"), "unknown-element", 1},
      {"colours: a drawing that nobody could draw", "",
       ON_ARM("<visual><geometry/><geometry/><material name=\"a\"><color rgba=\"1 0\"/></material>"
              "</visual>"),
       "", 1},
      {"colours: materials of one name", "",
       "<material name=\"a\"><color rgba=\"1 0 0 1\"/></material><material name=\"a\"/>", "", 1},
      {"sensors: links with a type", "",
       "<link name=\"x\" type=\"laser\"/>" PLACED("f", "fixed", "arm", "x"), "", 1},
      {"service arms: calibration of both edges", "",
       JOINT("continuous", "<calibration rising=\"0.0\" falling=\"-0.1\"/>"), "not-used", 2},
      {"wheels: casters that follow each other in a row", "",
       "<link name=\"y\">BODY</link><link name=\"z\">BODY</link>" JOINT(
           "continuous", "") "<joint name=\"l\" type=\"continuous\"><parent link=\"x\"/><child "
                             "link=\"y\"/><mimic "
                             "joint=\"k\" multiplier=\"2\"/></joint><joint name=\"m\" "
                             "type=\"continuous\"><parent "
                             "link=\"y\"/><child link=\"z\"/><mimic joint=\"l\" "
                             "multiplier=\"-0.5\" offset=\"1\"/>"
                             "</joint>",
       "", 2},
      {"lifts: a slide that states its end alone", "",
       JOINT("prismatic", "<limit upper=\"0.4\" effort=\"9\" velocity=\"1\"/>"), "joint-limits", 2},
      {"all over the world: names in letters of their own", "",
       "<link name=\"\xe6\x89\x8b\"/>" PLACED("\xc3\xa9paule", "fixed", "arm", "\xe6\x89\x8b"), "",
       1},
      {"schemas: a place of one without a namespace", "",
       "<link xsi:noNamespaceSchemaLocation=\"a.xsd\" name=\"x\"/>" PLACED("f", "fixed", "arm",
                                                                           "x"),
       "unknown-attribute", 1},
      {"flying arms: origins without one of the two", "",
       JOINT("continuous", "<origin rpy=\"0 0 1\"/><axis xyz=\"0 0 5\"/>"), "", 2},
      {"walkers: feet without mass and with a shape", "", SHAPE("<sphere radius=\".02\"/>"), "", 1},
      {"editors: a document type that is the root's name", "<!DOCTYPE robot>\n", "", "", 1},
  };
  return all;
}

std::vector<Finding> remarks_of(const std::string& text, const std::string& hand = "arm") {
  return read_urdf(text, "found.urdf", hand).remarks;
}

bool has_rule(const std::vector<Finding>& remarks, const std::string& rule) {
  return std::any_of(remarks.begin(), remarks.end(),
                     [&](const Finding& remark) { return remark.rule == rule; });
}

const Kind kPlain = {"", "", "", "", 1};

/// The plain text with one piece replaced.
std::string plain_with(const std::string& from, const std::string& to) {
  std::string text = robot_of(kPlain);
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace

TEST_CASE("more kinds of files are read, with the remark that they deserve") {
  CHECK(more_kinds().size() >= 34);
  for (const Kind& kind : more_kinds()) {
    INFO(kind.seen);
    RobotModel robot;
    REQUIRE_NOTHROW(robot =
                        read_urdf(robot_of(kind), "found.urdf", "arm", {.may_lack_base = true}));
    CHECK(robot.n() == kind.joints);
    std::string all;
    for (const Finding& remark : robot.remarks) all += to_string(remark) + "\n";
    INFO(all);
    const std::string rule = kind.rule;
    CHECK(robot.remarks.empty() == rule.empty());
    if (!rule.empty()) CHECK(has_rule(robot.remarks, rule));
  }
}

TEST_CASE("what is left out or assumed does not change the robot") {
  const RobotModel plain = read_urdf(robot_of(kPlain), "found.urdf", "arm");
  for (const Kind& kind : more_kinds()) {
    if (std::string(kind.rule) != "free-root" && std::string(kind.rule) != "lone-link") continue;
    INFO(kind.seen);
    const RobotModel robot = read_urdf(robot_of(kind), "found.urdf", "arm");
    CHECK(robot.links.size() == plain.links.size());
    CHECK(robot.base.name == plain.base.name);
    CHECK(robot.base.mass == plain.base.mass);
    CHECK(robot.joints[0].p == plain.joints[0].p);
  }
}

TEST_CASE("a robot without a name and a version of a model's own are read") {
  for (const char* name : {"", "name=\"\""}) {
    const RobotModel robot = read_urdf(plain_with("name=\"found\"", name), "found.urdf", "arm");
    CHECK(robot.name == "robot");
    CHECK(has_rule(robot.remarks, "robot-name"));
  }
  CHECK(has_rule(remarks_of(plain_with("name=\"found\"", "name=\"a\" version=\"0.3.1\"")),
                 "version"));
}

TEST_CASE("free joints that leave mass behind are refused") {
  const Kind ball = {"", "", JOINT("floating", ""), "", 0};
  CHECK_THROWS_WITH(remarks_of(robot_of(ball)), Catch::Contains("only the base floats"));
  const Kind moved = {"", "",
                      "<link name=\"w\"/><link name=\"o\"/>" PLACED("a", "continuous", "w", "o")
                          PLACED("p", "planar", "o", "base"),
                      "", 0};
  CHECK_THROWS_WITH(remarks_of(robot_of(moved)), Catch::Contains("only the base floats"));
}

TEST_CASE("digits that were written leave a little open, not more") {
  const auto with_izz = [](const std::string& izz) {
    return plain_with("izz=\"1.0E-1\"", "izz=\"" + izz + "\"");  // of the base; ixx, iyy: 0.1
  };
  CHECK(remarks_of(with_izz("0.2")).empty());
  CHECK(has_rule(remarks_of(with_izz("0.21")), "inertia"));
  CHECK_THROWS_WITH(remarks_of(with_izz("0.3")), Catch::Contains("triangle inequality"));
  CHECK_THROWS_WITH(
      remarks_of(plain_with(test::kInertialText,
                            "<inertial><mass value=\"1\"/><inertia ixx=\"0.10000\" iyy=\"1E-1\" "
                            "izz=\"0.2500\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>")),
      Catch::Contains("triangle inequality"));
}

TEST_CASE("texts of other encodings are read as UTF-8") {
  const std::string latin = "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<!-- d\xe9part -->" +
                            plain_with("\"j\"", "\"\xe9paule\"");
  const RobotModel robot = read_urdf(latin, "found.urdf", "arm");
  CHECK(robot.joints[0].name == "\xc3\xa9paule");
  CHECK(has_rule(robot.remarks, "encoding"));

  const std::string text = plain_with("\"j\"", "\"\xc3\xa9\xf0\x9f\xa4\x96\"");
  for (const bool is_big : {false, true}) {
    std::string wide = is_big ? "\xfe\xff" : "\xff\xfe";
    const auto add = [&](unsigned unit) {
      const char bytes[2] = {static_cast<char>(unit >> 8), static_cast<char>(unit & 0xff)};
      wide += bytes[is_big ? 0 : 1];
      wide += bytes[is_big ? 1 : 0];
    };
    const std::size_t letters = text.find('\xc3');
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (i == letters) {
        for (const unsigned unit : {0xe9u, 0xd83eu, 0xdd16u}) add(unit);
        i += 5;
      } else {
        add(static_cast<unsigned char>(text[i]));
      }
    }
    const RobotModel other = read_urdf(wide, "found.urdf", "arm");
    CHECK(other.joints[0].name == "\xc3\xa9\xf0\x9f\xa4\x96");
    CHECK(has_rule(other.remarks, "encoding"));
  }

  const std::string comment = "<!-- \xb7\xa2 -->\n" + robot_of(kPlain);
  CHECK(has_rule(remarks_of(comment), "encoding"));
  CHECK_THROWS_WITH(remarks_of(plain_with("\"j\"", "\"\xb7\xa2\"")), Catch::Contains("UTF-8"));
  // A plan carries the text: it is written anew.
  RobotAssembly assembly;
  assembly.add_robot(latin, {"found.urdf", {}}, "found.urdf");
  CHECK(read_urdf(assembly.text(), "again.urdf", "arm").joints[0].name == "\xc3\xa9paule");
}

}  // namespace stillbase
