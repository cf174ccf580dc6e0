// Every file that must be refused, with the rule and the line that the user is told.
#include <fmt/format.h>

#include <locale>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/robot/urdf_reader.hpp>

using namespace stillbase;

namespace {

// Lines of this text are counted in the tests below.
const std::string kGood = R"(<robot name="r">
<link name="base"><inertial>
<mass value="10"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
</inertial></link>
<link name="arm"><inertial>
<origin xyz="0 0 0.5" rpy="0 0 0"/>
<mass value="2"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>
</inertial>
<collision name="arm_capsule"><geometry>
<cylinder radius="0.1" length="1"/>
</geometry></collision></link>
<joint name="j" type="revolute">
<parent link="base"/>
<child link="arm"/>
<origin xyz="1 0 0"/>
<axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="1" effort="1"/>
</joint>
</robot>
)";

std::string with(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

std::string before_end(const std::string& addition) {
  return with("</robot>", addition + "</robot>");
}

std::vector<Finding> findings_of(const std::string& text, const std::string& hand = "") {
  try {
    read_urdf(text, "r.urdf", hand);
  } catch (const InputError& error) {
    return error.findings();
  }
  return {};
}

bool has(const std::vector<Finding>& findings, int line, const std::string& rule) {
  for (const Finding& f : findings) {
    if (f.line == line && f.rule == rule && f.file == "r.urdf" && !f.message.empty()) return true;
  }
  return false;
}

void refused(const std::string& text, int line, const std::string& rule) {
  const std::vector<Finding> findings = findings_of(text);
  std::string all;
  for (const Finding& f : findings) all += to_string(f) + "\n";
  INFO("expected line " << line << ", " << rule << "; findings:\n" << all);
  CHECK(has(findings, line, rule));
}

std::string massive_link(const std::string& name) {
  return "<link name=\"" + name +
         "\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" "
         "ixz=\"0\" iyz=\"0\"/></inertial></link>\n";
}

std::string joint(const std::string& name, const std::string& parent, const std::string& child) {
  return "<joint name=\"" + name + "\" type=\"continuous\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/></joint>\n";
}

}  // namespace

TEST_CASE("the file from which the refused ones are made is accepted") {
  CHECK(findings_of(kGood).empty());
}

TEST_CASE("texts that are no XML or no robot are refused") {
  refused("", 0, "xml");
  refused("garbage", 1, "xml");
  refused(kGood.substr(0, 300), 10, "xml");
  refused(with("</joint>", "</jiont>"), 14, "xml");  // where the element begins
  refused("<model name=\"r\"/>", 1, "xml");
  refused("<robot name=\"r\"/>", 1, "missing-element");
  refused(kGood + "<robot name=\"s\"/>", 22, "xml");
}

TEST_CASE("files that exceed the parser's limits are refused") {
  refused(std::string(kMaxUrdfBytes + 1, ' '), 0, "too-large");
  std::string deep;
  for (int i = 0; i < 50000; ++i) deep += "<a>";
  refused(before_end(deep), 21, "too-deep");
  std::string nested;
  for (int i = 0; i < 70; ++i) nested += "<visual>";
  for (int i = 0; i < 70; ++i) nested += "</visual>";
  refused(with("<collision", nested + "<collision"), 11, "too-deep");
  std::string links;
  for (int i = 0; i < kMaxUrdfLinks; ++i) links += fmt::format("<link name=\"x{}\"/>\n", i);
  refused(before_end(links), 21 + kMaxUrdfLinks - 2, "too-many-links");
  refused("<!DOCTYPE r [\n<!ENTITY a \"aaaa\">\n<!ENTITY b \"&a;&a;\">]>\n" + kGood, 1, "doctype");
  refused("<!DOCTYPE robot SYSTEM \"/etc/passwd\">\n" + kGood, 1, "doctype");
  refused(with("\"arm\"", std::string("\"a\0m\"", 5)), 6, "not-text");
  refused(with("\"arm\"", "\"a\xff\""), 6, "not-text");
  refused(with("\"arm\"", "\"a\xc0\xaf\""), 6, "not-text");
  refused(with("\"arm\"", "\"a\xed\xa0\x80\""), 6, "not-text");
}

TEST_CASE("numbers must be plain, finite numbers") {
  for (const char* text : {"1,5", "1.5kg", "abc", "", "0x10", "1e", "--1", "+-1", "1 2"}) {
    refused(with("value=\"2\"", std::string("value=\"") + text + "\""), 8, "not-a-number");
  }
  for (const char* text : {"nan", "inf", "-inf", "1e999", "NAN", "infinity"}) {
    refused(with("value=\"2\"", std::string("value=\"") + text + "\""), 8, "not-finite");
  }
  refused(with("xyz=\"0 0 0.5\"", "xyz=\"0 0\""), 7, "not-a-vector");
  refused(with("xyz=\"0 0 0.5\"", "xyz=\"0 0 0 1\""), 7, "not-a-vector");
  refused(with("xyz=\"0 0 0.5\"", "xyz=\"0 0 0,5\""), 7, "not-a-number");
  refused(with("rpy=\"0 0 0\"", "rpy=\"0 nan 0\""), 7, "not-finite");
  refused(with("ixx=\"0.1\"", "ixx=\"x\""), 9, "not-a-number");
  refused(with("lower=\"-1\"", "lower=\"nan\""), 19, "not-finite");
  // Finite, but its square is not.
  refused(with("xyz=\"0 0 0.5\"", "xyz=\"0 0 1e200\""), 7, "out-of-range");
  for (const char* text : {"+2.e0", " 2", "2\t", "\n2\n"}) {
    CHECK(findings_of(with("value=\"2\"", std::string("value=\"") + text + "\"")).empty());
  }
}

TEST_CASE("impossible masses and tensors are refused with the body's name") {
  refused(with("value=\"2\"", "value=\"-2\""), 8, "out-of-range");
  refused(with("value=\"2\"", "value=\"0\""), 6, "mass");
  refused(with("value=\"10\"", "value=\"0\""), 2, "mass");
  refused(with("ixx=\"0.1\"", "ixx=\"-0.1\""), 6, "inertia");
  refused(with("ixx=\"0.1\"", "ixx=\"0.3\""), 6, "inertia");
  refused(with("ixx=\"1\"", "ixx=\"0\""), 2, "inertia");
  const std::vector<Finding> findings = findings_of(with("ixx=\"0.1\"", "ixx=\"0.3\""));
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].message.find("'arm'") != std::string::npos);
  CHECK(findings[0].message.find("0.1, 0.1, 0.3") != std::string::npos);
  // A moving link without <inertial>, and without fixed links that bring mass.
  refused(before_end("<link name=\"x\"/>" + joint("k", "arm", "x")), 21, "mass");
}

TEST_CASE("joints that form no tree are refused") {
  refused(before_end(massive_link("x")), 21, "two-roots");
  refused(before_end(massive_link("x") + massive_link("y") + joint("k", "x", "y")), 21,
          "two-roots");
  // A detached cycle, a joint from a link to itself, and a file that is all cycle.
  refused(before_end(massive_link("x") + massive_link("y") + joint("k", "x", "y") +
                     joint("l", "y", "x")),
          22, "cycle");
  refused(before_end(massive_link("x") + joint("k", "x", "x")), 21, "cycle");
  refused(before_end(joint("k", "arm", "base")), 2, "cycle");
  refused(before_end(massive_link("x") + joint("k", "base", "x") + joint("l", "arm", "x")), 23,
          "two-parents");
  refused(before_end(joint("k", "arm", "nowhere")), 21, "unknown-link");
  refused(with("<parent link=\"base\"", "<parent link=\"bass\""), 14, "unknown-link");
  refused(before_end(massive_link("arm")), 21, "duplicate-name");
  refused(before_end(massive_link("x") + joint("j", "arm", "x")), 22, "duplicate-name");
  refused(with("<parent link=\"base\"/>", ""), 14, "missing-element");
  refused(with("<child link=\"arm\"/>", "<child/>"), 16, "missing-attribute");
}

TEST_CASE("joints that are not supported are refused with the reason") {
  for (const char* type : {"floating", "planar", "spherical", "Revolute", ""}) {
    const bool empty = std::string(type).empty();
    refused(with("type=\"revolute\"", std::string("type=\"") + type + "\""), 14,
            empty ? "missing-attribute" : "joint-type");
  }
  refused(with("<axis", "<mimic joint=\"j\"/><axis"), 14, "mimic");
  refused(with("xyz=\"0 0 1\"", "xyz=\"0 0 0\""), 18, "joint-axis");
  refused(with("<limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/>", ""), 14,
          "joint-limits");
  refused(with("upper=\"1\"", "upper=\"\""), 19, "not-a-number");
}

TEST_CASE("a robot with more joints that move than the matrices hold is refused") {
  const auto chain = [](int joints) {
    std::string text = "<robot name=\"r\">\n" + massive_link("x0");
    for (int k = 1; k <= joints; ++k) {
      const std::string parent = fmt::format("x{}", k - 1), child = fmt::format("x{}", k);
      text += massive_link(child) + joint(fmt::format("j{}", k), parent, child);
    }
    return text + "</robot>";
  };
  CHECK(findings_of(chain(kMaxJoints)).empty());
  const std::vector<Finding> findings = findings_of(chain(kMaxJoints + 1));
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].rule == "too-many-joints");
  CHECK(findings[0].line > 1);  // of the first joint too many
  CHECK(findings[0].message.find("65 movable joints, at most 64") != std::string::npos);
  CHECK(findings[0].message.find("`robot.locked`") != std::string::npos);
}

TEST_CASE("repeated elements and values at the wrong place are refused, not dropped") {
  refused(with("value=\"2\"", "value=\"2\" value=\"3\""), 8, "xml");
  refused(with("<mass value=\"2\"/>", "<mass value=\"2\"/><mass value=\"3\"/>"), 8,
          "repeated-element");
  refused(with("<mass value=\"2\"/>", "<mass>2</mass>"), 8, "missing-attribute");
  refused(with("<mass value=\"2\"/>", ""), 6, "mass");
  refused(before_end("<xacro:arm/>"), 21, "macro");
}

TEST_CASE("all findings of a stage come together") {
  std::string text = with("value=\"2\"", "value=\"nan\"");
  text.replace(text.find("xyz=\"0 0 1\""), 11, "xyz=\"0 0 0\"");
  const std::vector<Finding> findings = findings_of(text);
  CHECK(findings.size() == 2);
  CHECK(has(findings, 8, "not-finite"));
  CHECK(has(findings, 18, "joint-axis"));
}

TEST_CASE("a message never carries control characters or a whole long value") {
  const std::string value = "\x1b[2J" + std::string(5000, 'x');
  const std::vector<Finding> findings = findings_of(with("value=\"2\"", "value=\"" + value + "\""));
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].message.find('\x1b') == std::string::npos);
  CHECK(findings[0].message.size() < 200);
}

TEST_CASE("the hand must be a link of the robot, named when there are several leaves") {
  CHECK(findings_of(kGood, "base").empty());
  std::vector<Finding> findings = findings_of(kGood, "claw");
  REQUIRE(findings.size() == 1);
  CHECK(has(findings, 0, "hand-unknown"));
  CHECK(findings[0].message.find("'claw'") != std::string::npos);
  findings = findings_of(before_end(massive_link("second") + joint("k", "base", "second")));
  REQUIRE(findings.size() == 1);
  CHECK(has(findings, 0, "hand-missing"));
  CHECK(findings[0].message.find("arm second") != std::string::npos);
}

TEST_CASE("public models with impossible tensors are refused") {
  const std::string folder = STILLBASE_SOURCE_DIR "/tests/data/urdf/";
  std::vector<Finding> findings =
      findings_of(read_text_file(folder + "not_positive_definite.urdf"));
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].rule == "inertia");
  CHECK(findings[0].message.find("-0.0005, 0.002, 0.003") != std::string::npos);
  findings = findings_of(read_text_file(folder + "ets7_impossible_tensors.urdf"));
  REQUIRE(findings.size() == 3);
  for (const Finding& finding : findings) {
    CHECK(finding.rule == "inertia");
    CHECK(finding.message.find("triangle inequality") != std::string::npos);
  }
}

TEST_CASE("a decimal comma in the program's locale changes nothing") {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale previous = std::locale::global(std::locale(std::locale(), new Comma));
  const std::vector<Finding> good = findings_of(kGood);
  const std::vector<Finding> bad = findings_of(with("value=\"2\"", "value=\"1,5\""));
  const double z = good.empty() ? read_urdf(kGood, "", "").bodies[0].centroid.z() : 0;
  std::locale::global(previous);
  CHECK(good.empty());
  CHECK(has(bad, 8, "not-a-number"));
  CHECK(z == 0.5);
}

TEST_CASE("messages of robots read at the same time do not mix") {
  const std::string bad = with("</joint>", "</jiont>");
  std::vector<int> wrong(4, 0);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 50; ++i) {
        const bool expect_good = (i + t) % 2 == 0;
        if (findings_of(expect_good ? kGood : bad).empty() != expect_good) ++wrong[t];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(wrong == std::vector<int>(4, 0));
}
