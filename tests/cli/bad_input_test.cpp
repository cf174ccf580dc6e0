#include <catch2/catch.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;

namespace {

struct BadFile {
  const char *what, *from, *to, *rule, *key;
};

constexpr const char* kProblem = "problems/planar_two_link_c2_a.yaml";
constexpr const char* kRobot = "problems/robots/planar_two_link_a.urdf";

/// Exit 3, one line `file:line: rule: message` that names the key, and nothing written.
void require_refused(const Workshop& shop, const Outcome& outcome, const std::string& place,
                     const std::string& rule, const std::string& key) {
  INFO(outcome.err);
  CHECK(outcome.code == 3);
  CHECK(outcome.says(place + ": " + rule + ": "));
  CHECK(outcome.says(key));
  CHECK(outcome.out.empty());
  CHECK_FALSE(shop.has("plan.json"));
}

}  // namespace

TEST_CASE("a problem file that breaks a rule is refused with file, line, rule and key") {
  const auto bad = GENERATE(
      BadFile{"unknown key", "  restitution: 1", "  bounce: 1", "unknown-key", "bounce"},
      BadFile{"duplicate key", "  restitution: 1", "  source: point_mass", "duplicate-key",
              "source"},
      BadFile{"wrong unit", "closing_speed: 1 m/s", "closing_speed: 1 kg", "wrong-unit",
              "closing_speed"},
      BadFile{"NaN", "closing_speed: 1 m/s", "closing_speed: .nan", "not-finite", "closing_speed"},
      BadFile{"infinite", "closing_speed: 1 m/s", "closing_speed: .inf", "not-finite",
              "closing_speed"},
      BadFile{"restitution", "restitution: 1", "restitution: 1.5", "out-of-range", "restitution"},
      BadFile{"hand link", "hand: hand", "hand: claw", "hand-unknown", "claw"});
  const Workshop shop;
  const int line = shop.write_changed("problem.yaml", kProblem, bad.from, bad.to);
  const Outcome outcome = shop.run("plan problem.yaml -o plan.json");
  INFO(bad.what);
  require_refused(shop, outcome, "problem.yaml:" + std::to_string(line), bad.rule, bad.key);
}

TEST_CASE("what only the planner finds has the line of the key, or of the section that lacks it") {
  const Workshop shop;
  const int line = shop.write_changed("problem.yaml", kProblem, "  joints: all", "  joints: none");
  const auto place = [](int at) { return "problem.yaml:" + std::to_string(at); };
  require_refused(shop, shop.run("plan problem.yaml -o plan.json"), place(line - 1), "no-variables",
                  "variables: nothing is free");
  shop.write_changed("one.yaml", kProblem, "  joints: all", "  joints: [joint_1]");
  const Outcome few = shop.run("check one.yaml");
  INFO(few.err);
  CHECK(few.code == 3);
  CHECK(few.says("one.yaml:" + std::to_string(line - 1) + ": too-few-variables: variables: "));
}

TEST_CASE("what a misspelt section leaves out has the line of the map that lacks it") {
  const Workshop shop;
  const int line = shop.write_changed("problem.yaml", kProblem, "\nimpact:", "\nimpct:") + 1;
  const int first = shop.write_changed("problem.yaml", kProblem, "format:", "format:");
  shop.write_changed("problem.yaml", kProblem, "\nimpact:", "\nimpct:");
  const Outcome outcome = shop.run("plan problem.yaml -o plan.json");
  require_refused(shop, outcome, "problem.yaml:" + std::to_string(first), "missing-key",
                  "impact.source");
  require_refused(shop, outcome, "problem.yaml:" + std::to_string(line), "unknown-key", "'impct'");
}

TEST_CASE("a start outside the joint limits is refused") {
  const Workshop shop;
  const int line = shop.write_changed("problem.yaml", "problems/iiwa_client_50.yaml",
                                      "start: [70 deg", "start: [190 deg");
  const Outcome outcome = shop.run("plan problem.yaml -o plan.json");
  require_refused(shop, outcome, "problem.yaml:" + std::to_string(line), "outside-limits", "start");
}

TEST_CASE("a target without mass is refused in the file that says so") {
  const Workshop shop;
  shop.write("problem.yaml", file_text(source_path(kProblem)));
  const int line =
      shop.write_changed("targets/point_mass_100.yaml", "problems/targets/point_mass_100.yaml",
                         "mass: 100 kg", "mass: 0 kg");
  const Outcome outcome = shop.run("plan problem.yaml -o plan.json");
  require_refused(shop, outcome, "targets/point_mass_100.yaml:" + std::to_string(line),
                  "out-of-range", "mass");
}

TEST_CASE("a missing file is refused by every command that reads one") {
  const Workshop shop;
  for (const char* command :
       {"check none.yaml", "check none.urdf", "check none.json", "plan none.yaml -o plan.json",
        "inspect none.urdf", "analyze none.yaml", "simulate none.yaml", "simulate none.json"}) {
    INFO(command);
    const Outcome outcome = shop.run(command);
    require_refused(shop, outcome,
                    std::string(command).substr(std::string(command).find("none"), 9),
                    "missing-file", "none");
  }
}

TEST_CASE("a robot that cannot exist is refused with its line") {
  const auto bad = GENERATE(
      BadFile{"zero mass", "<mass value=\"100\"/>", "<mass value=\"0\"/>", "mass", "link_1"},
      BadFile{"negative mass", "<mass value=\"100\"/>", "<mass value=\"-1\"/>", "out-of-range",
              "mass"},
      BadFile{"impossible inertia", "izz=\"563.3\"", "izz=\"5633\"", "inertia", "base"},
      BadFile{"unknown joint type", "type=\"continuous\"", "type=\"spherical\"", "joint-type",
              "spherical"},
      BadFile{"two roots", "<link name=\"hand\"/>", "<link name=\"hand\"/><link name=\"stray\"/>",
              "root", "stray"},
      BadFile{"cycle", "<child link=\"link_1\"/>", "<child link=\"base\"/>", "", "base"});
  const Workshop shop;
  const int line = shop.write_changed("robots/planar_two_link_a.urdf", kRobot, bad.from, bad.to);
  shop.write("problem.yaml", file_text(source_path(kProblem)));
  INFO(bad.what);
  for (const char* command :
       {"plan problem.yaml -o plan.json", "check robots/planar_two_link_a.urdf"}) {
    const Outcome outcome = shop.run(command);
    INFO(outcome.err << line);
    CHECK(outcome.code == 3);
    CHECK(outcome.says("robots/planar_two_link_a.urdf:"));
    CHECK(outcome.says(bad.rule));
    CHECK(outcome.says(bad.key));
    CHECK_FALSE(shop.has("plan.json"));
  }
}

TEST_CASE("all findings of a file are reported together, one per line") {
  const Workshop shop;
  shop.write_changed("one.yaml", kProblem, "restitution: 1", "restitution: 1.5");
  std::string text = shop.text("one.yaml");
  text.replace(text.find("closing_speed: 1 m/s"), 20, "closing_speed: 1 kg ");
  shop.write("problem.yaml", text);
  const Outcome outcome = shop.run("check problem.yaml");
  CHECK(outcome.code == 3);
  CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 2);
}

TEST_CASE("a wrong command line is exit code 2, and help is not an error") {
  const Workshop shop;
  CHECK(shop.run("").code == 2);
  CHECK(shop.run("frobnicate").code == 2);
  CHECK(shop.run("plan").code == 2);
  CHECK(shop.run("plan x.yaml --starts 0").code == 2);
  CHECK(shop.run("check robots.txt").code == 2);
  CHECK(shop.run("--help").code == 0);
  CHECK(shop.run("plan --help").code == 0);
  CHECK(shop.run("--version").out.find("stillbase ") == 0);
  shop.write("problem.yaml", file_text(source_path(kProblem)));
  const Outcome outcome = shop.run("plan problem.yaml --optimizer wishful");
  CHECK(outcome.code == 2);
  CHECK(outcome.says("nlopt-slsqp"));
}

TEST_CASE("inspect asks for the hand when the robot has several ends") {
  const Workshop shop;
  shop.write_changed("two.urdf", kRobot, "<link name=\"hand\"/>",
                     "<link name=\"hand\"/><link name=\"lamp\"/>"
                     "<joint name=\"lamp_joint\" type=\"fixed\"><parent link=\"base\"/>"
                     "<child link=\"lamp\"/></joint>");
  const Outcome asked = shop.run("inspect two.urdf --json");
  CHECK(asked.code == 2);
  CHECK(asked.says("--hand"));
  CHECK(asked.out.empty());
  CHECK(shop.run("inspect two.urdf --hand lamp --json").code == 0);
  CHECK(shop.run("inspect two.urdf --hand nothing --json").code == 3);
}
