#include <set>

#include <catch2/catch.hpp>

#include "io/io_support.hpp"
#include "io/problem_reader.hpp"
#include "io/schema_subjects.hpp"

using namespace stillbase;
using namespace stillbase::io_test;

namespace {

/// First cells of the table of a problem's fields: `a.b`.
std::set<std::string> documented_fields() {
  std::set<std::string> fields;
  std::istringstream lines(problem_fields_text());
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| `", 0) != 0) continue;
    const std::size_t begin = line.find('`') + 1;
    fields.insert(line.substr(begin, line.find('`', begin) - begin));
  }
  return fields;
}

/// Keys whose parts are described once for all fields, above the table.
bool is_described_above(const std::string& key) {
  for (const char* part :
       {"orientation.", "geometry.", "inertia.", "angular_velocity.", "impact.direction.",
        "robot.base.shape.", "robot.limits.", "robot.locked.", "robot.rotors."}) {
    if (key.find(part) != std::string::npos) return true;
  }
  return false;
}

/// Keys that the reader asks for in this text.
std::set<std::string> known_keys(const std::string& text) {
  io::ReadContext context{source_path("problems/x.yaml"), {}, {}};
  const io::Node root = io::parse_document(text, context);
  io::read_problem_map(root, context, "", {.folder = source_path("problems")});
  INFO(text_of(context.findings));
  REQUIRE(context.findings.empty());
  return context.known_keys;
}

const std::string kEverything = R"(format: stillbase.problem
version: 1
purpose: Every optional map is there, so that the reader asks for everything.
robot:
  file: robots/planar_two_link_a.urdf
  start: [0, 0]
  base: {position: [0, 0, 0]}
target:
  name: client
  model: rigid_body
  mass: 50
  inertia: {ixx: 3, iyy: 3, izz: 3}
  shapes: [{geometry: {sphere: {radius: 1}}}]
  features: [{name: a, point: [1, 0, 0], normal: [1, 0, 0]}]
  state: {linear_velocity: [-1, 0, 0], covariance: {orientation: 0.1}}
impact:
  source: rigid_body
  joint_resistance: RESISTANCE
variables:
  base_attitude: {freedom: free}
  base_position: {freedom: free}
  contact_time: {lower: 0, upper: 1}
objective: OBJECTIVE
post_impact: {contact: {model: instantaneous}, sensor: {}, model: {}, thrusters: {}}
obstacles: [{name: o, position: [9, 9, 9], geometry: {sphere: {radius: 1}}}]
)";

}  // namespace

TEST_CASE("the documented table of fields and the reader's keys are the same") {
  std::set<std::string> known;
  for (const char* resistance :
       {"{model: rotor_inertia, rotor_inertia: 1}", "{model: locked, locked: all}",
        "{model: servo, stiffness: 1, damping: 1, contact_duration: 1}"}) {
    for (const char* objective :
         {"{quantity: total_angular_momentum}",
          "{terms: [{quantity: base_momentum, size: 1 N s, length: 2 m}]}"}) {
      const std::string text = replaced(kEverything, "OBJECTIVE", objective);
      for (const std::string& key : known_keys(replaced(text, "RESISTANCE", resistance))) {
        if (!is_described_above(key)) known.insert(key);
      }
    }
  }
  for (const std::string& text : {std::string(kParts), kMatched, kResidual, kStatedResidual}) {
    for (const std::string& key : known_keys(text)) {
      if (!is_described_above(key)) known.insert(key);
    }
  }
  std::set<std::string> documented;
  for (const std::string& key : documented_fields()) {
    if (!is_described_above(key)) documented.insert(key);
  }
  CHECK(documented.size() > 90);
  for (const std::string& key : known) {
    INFO(key << " is read but not documented");
    CHECK(documented.count(key) == 1);
  }
  for (const std::string& key : documented) {
    INFO(key << " is documented but not read");
    CHECK(known.count(key) == 1);
  }
}

TEST_CASE("the table of fields states the defaults of the data") {
  const CaptureProblem defaults;
  const std::string readme = problem_fields_text();
  const auto states = [&](const std::string& field, const std::string& value) {
    const std::size_t row = readme.find("| `" + field + "`");
    REQUIRE(row != std::string::npos);
    const std::string line = readme.substr(row, readme.find('\n', row) - row);
    INFO(line);
    CHECK(line.substr(line.size() - value.size() - 4) == "| " + value + " |");
  };
  states("search.optimizer", "`" + defaults.search.optimizer + "`");
  CHECK(defaults.search.starts == kAutomaticStarts);
  states("search.starts", "`auto`");
  states("search.max_candidates", std::to_string(defaults.search.max_candidates));
  states("approach.planner", "`" + defaults.approach.planner + "`");
  states("approach.max_iterations", std::to_string(defaults.approach.max_iterations));
  states("approach.wait", "5");
  CHECK(defaults.approach.wait == 5);
  states("constraints.closing_speed_min", "0.001");
  CHECK(defaults.constraints.closing_speed_min == 0.001);
}
