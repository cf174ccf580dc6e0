// The schemas and the hand-written readers say the same: what the readers take and refuse, the
// schemas take and refuse, as far as a schema can know.
#include <algorithm>
#include <cctype>
#include <fstream>
#include <functional>
#include <optional>

#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/sha256.hpp>
#include <stillbase/io/campaign_file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/io/schema.hpp>
#include <stillbase/io/state_file.hpp>
#include <stillbase/io/suite_file.hpp>
#include <stillbase/io/target_file.hpp>

#include "io/io_support.hpp"
#include "io/plan_samples.hpp"
#include "io/problem_reader.hpp"
#include "io/scan.hpp"
#include "io/units.hpp"
#include "support/schema_check.hpp"

using namespace stillbase;
using namespace stillbase::io_test;
using namespace stillbase::test;

namespace {

/// A parsed file with the types that YAML gives its values.
json typed(const io::Node& node) {
  switch (node.kind) {
    case io::Node::Kind::Null:
      return nullptr;
    case io::Node::Kind::Quoted:
      return node.text;
    case io::Node::Kind::Plain: {
      if (node.text == "true" || node.text == "false") return node.text == "true";
      const io::Scanned number = io::scan_number(node.text);
      if (number.result != io::Scanned::Result::Good || !number.rest.empty()) return node.text;
      if (node.text.find_first_of(".eE") != std::string::npos) return number.value;
      return static_cast<std::int64_t>(number.value);
    }
    case io::Node::Kind::Sequence: {
      json list = json::array();
      for (const io::Node& item : node.items) list.push_back(typed(item));
      return list;
    }
    case io::Node::Kind::Map: {
      json map = json::object();
      for (std::size_t i = 0; i < node.keys.size(); ++i) map[node.keys[i]] = typed(node.items[i]);
      return map;
    }
  }
  return nullptr;
}

json yaml(const std::string& text) {
  io::ReadContext context{"test.yaml", {}, {}};
  const io::Node root = io::parse_document(text, context);
  REQUIRE(context.findings.empty());
  return typed(root);
}

json schema(const std::string& name) { return json::parse(schema_of(name)); }

/// A format with its reader and documents that between them use every key.
struct Subject {
  std::string name;
  std::function<void(const std::string& text)> read;
  std::vector<json> documents;

  std::vector<Finding> findings(const json& document) const {
    try {
      read(document.dump());
    } catch (const InputError& error) {
      return error.findings();
    } catch (const FileError& error) {
      return {{"", 0, "no-file", error.what()}};
    }
    return {};
  }
};

void read_problem_here(const std::string& text) {
  io::ReadContext context{source_path("problems/x.yaml"), {}, {}};
  const io::Node root = io::parse_document(text, context);
  io::read_problem_map(root, context, "", {.folder = source_path("problems")});
  context.throw_if_any();
}

constexpr const char* kPlanar = R"(
format: stillbase.problem
version: 1
name: planar
purpose: Alternatives that the shipped files do not use.
robot: {file: robots/planar_two_link_a.urdf, start: {joint_1: 10 deg, joint_2: 0}}
target: {file: targets/point_mass_100.yaml}
impact:
  source: point_mass
  direction: {angle: 170 deg}
  closing_speed: 1
  joint_resistance: {model: locked, locked: [joint_1]}
variables:
  joints: [joint_2]
  base_attitude: {freedom: axis, axis: [0, 0, 2], max: 10 deg}
  base_position: {freedom: box, lower: [0, 0, 0], upper: [1 m, 1, 0]}
  contact_time: 2 min
objective: {terms: [{quantity: base_momentum, size: 1 N s, length: 2 m}, {quantity: joint_rate_norm, size: 1}], measure: cvar}
hand: {constraint: position, position: [1, 0, 0]}
constraints: {joint_rate_max: {joint_1: 1, joint_2: 1 rad/s}, clearance: 1 mm}
uncertainty: {cone_half_angle: 5 deg, cone_plane: xy, joint_position: {joint_1: 1 deg, joint_2: 0}}
obstacles:
  - {name: a, orientation: {rpy: [0, 0, 90 deg]}, geometry: {capsule: {radius: 1 m, length: 1}}, position: [0, 50, 0]}
  - {name: b, orientation: {axis: [0, 0, 1], angle: 1}, geometry: {cylinder: {radius: 1, length: 1}}, position: [9, 50, 0]}
  - name: c
    position: [0, 0, 99]
    geometry:
      convex_mesh:
        vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        faces: [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
)";

constexpr const char* kTumbling = R"(
format: stillbase.problem
version: 1
purpose: A target with an uncertain estimate.
robot: {file: robots/planar_two_link_a.urdf, start: [0, 0], allowed_contacts: [[base, link_2]]}
target:
  name: client
  model: rigid_body
  mass: 50 kg
  inertia: {ixx: 3, iyy: 3 kg m^2, izz: 3}
  shapes: [{geometry: {box: {size: [1, 1, 1]}}}]
  features: [{name: a, point: [1, 0, 0], normal: [1, 0, 0]}, {name: b, point: [0, 1, 0], normal: [0, 1, 0]}]
  state:
    linear_velocity: [-1, 0, 0]
    angular_velocity: {axis: [0, 0, 1], rate: 1 deg/s}
    covariance: {position: 1 mm, orientation: [0.1, 0.1, 0.1], linear_velocity: 0, angular_velocity: 0, mass: 0.1, moments: 0.1}
impact:
  source: rigid_body
  joint_resistance: free
variables:
  base_attitude: {freedom: cone, axis: [0, 0, 1], max: 0.1}
  feature: a
objective: {quantity: base_angular_velocity}
constraints: {joint_rate_scale: 0.5}
uncertainty: {cone_half_angle: from_covariance, confidence: 0.9}
post_impact: {contact: latch}
)";

Subject problem_subject() {
  Subject subject{"problem", read_problem_here, {yaml(kPlanar), yaml(kTumbling)}};
  for (const char* name :
       {"planar_two_link_c2_a", "planar_two_link_post_impact_a", "iiwa_cone", "deos_features"}) {
    const std::string path = source_path(std::string("problems/") + name + ".yaml");
    json stated = yaml(file_text(path));
    subject.documents.push_back(stated);
    // The copy that plans hold states every field.
    subject.documents.push_back(json::parse(problem_to_json(read_problem(path))));
  }
  CaptureProblem servo = read_problem(source_path("problems/spart_3dof_point.yaml"));
  servo.resistance = {};
  servo.resistance.model = ResistanceModel::Servo;
  servo.resistance.stiffness = servo.resistance.damping = JointVectord::Ones(servo.robot.n());
  servo.resistance.contact_duration = 1;
  subject.documents.push_back(json::parse(problem_to_json(servo)));
  return subject;
}

Subject plan_subject() {
  Subject subject{"plan", [](const std::string& text) { read_plan(text, "plan.json"); }, {}};
  const std::vector<InputFile> inputs{{"problem", "a.yaml", sha256_hex("")}};
  const auto add = [&](const Plan& plan) {
    subject.documents.push_back(
        json::parse(plan_to_json(plan, {{"stillbase", "0.1.0"}}, "", inputs)));
  };
  add(random_plan());
  Plan locked = random_plan();
  locked.problem.resistance = locked.impact.resistance = {};
  locked.problem.resistance.model = locked.impact.resistance.model = ResistanceModel::Locked;
  locked.problem.resistance.locked = locked.impact.resistance.locked = {true, false};
  locked.problem.objective.clear();
  for (const auto& [word, quantity] : io::objective_names()) {
    locked.problem.objective.push_back({quantity, 2, 3});
    locked.objective.terms[std::string(word)] = 1;
  }
  add(locked);
  Plan choice = random_plan("problems/deos_features.yaml");
  choice.problem.resistance = choice.impact.resistance =
      read_problem(source_path("problems/deos_features.yaml")).resistance;
  choice.configuration.feature = choice.nominal_optimum->configuration.feature = "lower_edge";
  for (Candidate& candidate : choice.candidates) candidate.configuration.feature = "upper_edge";
  add(choice);
  return subject;
}

Subject suite_subject() {
  json suite = yaml(file_text(source_path("bench/suite.yaml")));
  suite["families"].erase(1);
  for (json& family : suite["families"]) {
    family["problem"] = source_path("bench/" + family["problem"].get<std::string>());
    family["free_attitude"] = "10 deg";
    family["free_contact_time"] = 1;
    family["cone_half_angle"] = "10 deg";
    family["case"] = "C2";
  }
  while (suite["families"].size() > 1) suite["families"].erase(1);
  const auto read = [](const std::string& text) {
    const std::string path =
        (std::filesystem::temp_directory_path() / "stillbase_schema_test_suite.yaml").string();
    write_file_atomically(path, text, true);
    read_suite(path);
  };
  return {"suite", read, {suite}};
}

std::vector<Subject> subjects() {
  const RobotModel robot = read_problem(source_path("problems/planar_two_link_c2_a.yaml")).robot;
  std::vector<Subject> all{problem_subject(), plan_subject(), suite_subject()};
  all.push_back({"target",
                 [](const std::string& text) { read_target_text(text, "target.yaml"); },
                 {yaml(file_text(source_path("problems/targets/client_50.yaml"))),
                  yaml(file_text(source_path("problems/targets/point_mass_100.yaml")))}});
  all.push_back({"campaign",
                 [](const std::string& text) { read_campaign_spec(text, "campaign.yaml"); },
                 {{{"format", "stillbase.campaign"},
                   {"version", 1},
                   {"plans", {"a.json"}},
                   {"problems", {"a.yaml"}},
                   {"seeds", {1, 2}},
                   {"trials", 7},
                   {"trials_per_case", 2}}}});
  all.push_back({"state",
                 [robot](const std::string& text) { read_state(text, "state.json", robot); },
                 {yaml("joint_positions: {joint_1: 10 deg, joint_2: 1}\n"
                       "joint_velocities: [1, 1 rad/s]"),
                  yaml("joint_positions: [10 deg, 1]\njoint_velocities: {joint_1: 1, joint_2: 2}\n"
                       "base_velocity: {linear: [1, 2, 3], angular: [1, 2, 3]}\n"
                       "impulse: {force: [1, 2, 3], moment: [1, 2, 3 N m s]}")}});
  return all;
}

/// The words after the last "; what: a, b" of a message.
std::optional<std::set<std::string>> listed(const std::string& message,
                                            const std::vector<std::string>& labels) {
  for (const std::string& label : labels) {
    const std::size_t at = message.rfind("; " + label + ": ");
    if (at == std::string::npos) continue;
    std::set<std::string> words;
    std::istringstream list(message.substr(at + label.size() + 4));
    for (std::string word; std::getline(list, word, ',');) {
      words.insert(word.substr(word.find_first_not_of(' ')));
    }
    words.erase("(none)");
    return words;
  }
  return std::nullopt;
}

/// Places of a plan where the problem decides which of the schema's keys there are, and those whose
/// keys exclude each other: objective.quantity and terms, target.file and the fields of a target.
bool depends_on_others(const std::string& subject, const std::string& place) {
  static const std::set<std::string> kInPlans{"configuration", "candidates[]",
                                              "objective.nominal_optimum", "objective.terms",
                                              "impact.joint_resistance_values"};
  return place == "objective" || place == "problem.objective" || place == "target" ||
         place == "problem.target" || (subject == "plan" && kInPlans.count(place) > 0);
}

/// Orientations and geometries are the same everywhere: their part of a place's name, or all of it.
std::string shared_part(const std::string& place) {
  for (const char* value : {"orientation.", "geometry."}) {
    const std::size_t at = place.find(value);
    if (at != std::string::npos) return place.substr(at);
  }
  return place;
}

bool starts_with(const std::string& text, const std::string& with) {
  return text.rfind(with, 0) == 0;
}

}  // namespace

TEST_CASE("every schema stands alone and uses words of draft-07 that validators know") {
  static const std::set<std::string> kKnown{"$schema",
                                            "title",
                                            "description",
                                            "type",
                                            "required",
                                            "additionalProperties",
                                            "items",
                                            "minItems",
                                            "maxItems",
                                            "minimum",
                                            "exclusiveMinimum",
                                            "maximum",
                                            "pattern",
                                            "enum",
                                            "const",
                                            "anyOf",
                                            "allOf",
                                            "oneOf",
                                            "not",
                                            "$ref",
                                            "properties",
                                            "definitions",
                                            "uniqueItems",
                                            "minProperties",
                                            "maxProperties"};
  REQUIRE(file_formats().size() > 10);
  for (const FileFormat& format : file_formats()) {
    INFO(format.name);
    CHECK(format.description.back() == '.');
    const json whole = schema(format.name);
    CHECK(whole.at("$schema") == "http://json-schema.org/draft-07/schema#");
    CHECK_NOTHROW(SchemaCheck(whole));
    const std::function<void(const json&)> look = [&](const json& node) {
      for (const auto& [key, value] : node.items()) {
        INFO(key);
        CHECK(kKnown.count(key) == 1);
        if (key == "$ref") {
          CHECK(starts_with(value, "#/definitions/"));
          CHECK_NOTHROW(referenced(whole, node));
          CHECK(node.size() == 1);  // what stands beside a reference does not count
        }
        if (key == "properties" || key == "definitions") {
          for (const json& part : value) look(part);
        } else if (value.is_object()) {
          look(value);
        } else if (key == "anyOf" || key == "allOf" || key == "oneOf") {
          for (const json& part : value) look(part);
        }
      }
    };
    look(whole);
  }
  CHECK_THROWS_AS(schema_of("poem"), std::invalid_argument);
  CHECK_THROWS_AS(schema_of("definitions"), std::invalid_argument);
}

TEST_CASE("every shipped file is accepted by its schema") {
  SchemaCheck problem(schema("problem")), target(schema("target"));
  for (const std::string& path : shipped_problems()) {
    INFO(path);
    CHECK(problem.complaints(yaml(file_text(path))) == "");
  }
  int targets = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_path("problems/targets"))) {
    INFO(entry.path());
    CHECK(target.complaints(yaml(file_text(entry.path().string()))) == "");
    ++targets;
  }
  CHECK(targets >= 4);
  CHECK(SchemaCheck(schema("suite")).complaints(yaml(file_text(source_path("bench/suite.yaml")))) ==
        "");
  CHECK(SchemaCheck(schema("best_known"))
            .complaints(json::parse(file_text(source_path("bench/best_known.json")))) == "");
}

TEST_CASE("schemas and readers know the same keys") {
  std::set<std::string> reached;  // of one subject, with the shared parts of all
  for (const Subject& subject : subjects()) {
    const json whole = schema(subject.name);
    const SchemaPlaces places = places_of(whole);
    SchemaCheck check(whole);
    std::set<std::string> before;
    for (const std::string& place : reached) {
      if (starts_with(place, "orientation.") || starts_with(place, "geometry.")) {
        before.insert(place);
      }
    }
    reached = before;
    for (const json& document : subject.documents) {
      INFO(subject.name << " " << document.dump().substr(0, 300));
      REQUIRE(text_of(subject.findings(document)) == "");
      REQUIRE(check.complaints(document) == "");
      std::set<std::string> seen;
      for (const Place& place : values_of(document)) {
        json changed = document;
        json& object = at_place(changed, place.way);
        if (!object.is_object()) continue;
        std::string keys;
        for (const auto& [key, value] : object.items()) keys += " " + key;
        if (!seen.insert(place.name + keys).second) continue;
        INFO("at '" << place.name << "'");
        const AllowedKeys allowed = keys_at(whole, document, place.way);
        object["zzz"] = 1;
        std::optional<std::set<std::string>> read;
        for (const Finding& finding : subject.findings(changed)) {
          if (finding.rule == "unknown-key") read = listed(finding.message, {"allowed"});
        }
        if (!read) {
          // Names of joints and the like.
          CHECK(allowed.any);
          reached.insert(shared_part(joined(place.name, "*")));
          continue;
        }
        CHECK_FALSE(allowed.any);
        CHECK_FALSE(check.accepts(changed));
        for (const std::string& key : *read) {
          INFO("read: " << key);
          CHECK(places.all.count(joined(place.name, key)) == 1);
          reached.insert(shared_part(joined(place.name, key)));
        }
        if (depends_on_others(subject.name, place.name)) continue;
        CHECK(read->size() == allowed.names.size());
        for (const std::string& key : allowed.names) {
          INFO("in the schema: " << key);
          CHECK(read->count(key) == 1);
        }
      }
    }
    INFO(subject.name);
    for (const std::string& place : places.all) {
      // The problem in a plan is the problem's; a plan's reader leaves the verdict alone.
      const bool is_elsewhere = subject.name == "plan" && (starts_with(place, "problem.") ||
                                                           starts_with(place, "verification."));
      INFO("in the schema, never reached: " << place);
      CHECK((is_elsewhere || reached.count(shared_part(place)) == 1));
    }
  }
}

TEST_CASE("schemas and readers know the same words") {
  // A word alone is allowed there only where it needs no more.
  static const std::set<std::string> kWordOrMap{
      "variables.base_attitude", "variables.base_position", "impact.joint_resistance"};
  int compared = 0;
  for (const Subject& subject : subjects()) {
    if (subject.name == "plan") continue;  // its own words: below
    const SchemaPlaces places = places_of(schema(subject.name));
    for (const json& document : subject.documents) {
      for (const Place& place : values_of(document)) {
        json changed = document;
        json& text = at_place(changed, place.way);
        if (!text.is_string() || kWordOrMap.count(place.name) > 0) continue;
        text = "zzz";
        for (const Finding& finding : subject.findings(changed)) {
          if (finding.rule != "unknown-name") continue;
          const auto words =
              listed(finding.message, {"allowed", "optimizers", "planners", "controllers"});
          if (!words) continue;
          INFO(subject.name << " " << place.name << ": " << finding.message);
          REQUIRE(places.words.count(place.name) == 1);
          std::set<std::string> known = places.words.at(place.name);
          // Builds of NLopt without C++ code lack it.
          if (place.name == "search.optimizer" && words->count("nlopt-stogo") == 0) {
            known.erase("nlopt-stogo");
          }
          // Words beside which other values stand.
          for (const char* word : {"feature", "from_restitution"}) {
            if (words->count(word) == 0) known.erase(word);
          }
          CHECK(known == *words);
          ++compared;
        }
      }
    }
  }
  CHECK(compared > 50);
  const SchemaPlaces plan = places_of(schema("plan"));
  const auto same = [&](const std::string& place, const auto& names) {
    std::set<std::string> words;
    for (const std::string& word : io::words_of(names)) words.insert(word);
    INFO(place);
    CHECK(plan.words.at(place) == words);
  };
  same("status", io::plan_status_names());
  same("impact.case", io::impact_case_names());
  same("impact.joint_resistance", io::resistance_names());
  same("objective.measure", io::measure_names());
  same("certificate.proof.status", io::proof_status_names());
  same("approach.status", io::approach_status_names());
  same("approach.polish.quantity", io::path_polish_names());
}

TEST_CASE("a schema accepts what the reader accepts, and refuses wrong types, units and ranges") {
  // What a schema cannot know: how many joints there are, what other fields ask for.
  const std::set<std::string> kForm{"unknown-key", "wrong-type", "unknown-unit", "wrong-unit"};
  const std::vector<json> values{
      "zzz zzz",    "1 parsec",    3,   -1,        0.75,        1000000000000, true, nullptr,
      {{"zzz", 1}}, json::array(), {1}, {1, 2, 3}, {{"a", "b"}}};
  int refused = 0, accepted = 0;
  for (const Subject& subject : subjects()) {
    SchemaCheck check(schema(subject.name));
    std::set<std::string> seen;
    // Plans take their time: there every place meets a third of the values.
    const std::size_t stride = subject.name == "plan" ? 3 : 1;
    for (const json& document : subject.documents) {
      for (const Place& place : values_of(document)) {
        const bool is_copy = subject.name == "plan" && starts_with(place.name, "problem.");
        if (is_copy || !seen.insert(place.name).second) continue;
        for (std::size_t i = seen.size() % stride; i < values.size(); i += stride) {
          const json& value = values[i];
          json changed = document;
          at_place(changed, place.way) = value;
          const std::vector<Finding> findings = subject.findings(changed);
          INFO(subject.name << " " << place.name << ": " << value << "\n" << text_of(findings));
          const bool is_accepted = check.accepts(changed);
          if (findings.empty()) {
            CHECK(check.complaints(changed) == "");
            ++accepted;
          } else if (std::any_of(findings.begin(), findings.end(), [&](const Finding& finding) {
                       return kForm.count(finding.rule) > 0;
                     })) {
            CHECK_FALSE(is_accepted);
            ++refused;
          } else if (findings.front().rule == "out-of-range" && value.is_number() &&
                     findings.front().message.find("is not allowed; must be") !=
                         std::string::npos) {
            CHECK_FALSE(is_accepted);
            ++refused;
          }
        }
      }
    }
  }
  CHECK(refused > 2000);
  CHECK(accepted > 200);
}

TEST_CASE("a schema accepts a file without a key wherever the reader does") {
  int required = 0;
  for (const Subject& subject : subjects()) {
    SchemaCheck check(schema(subject.name));
    std::set<std::string> seen;
    for (const json& document : subject.documents) {
      for (const Place& place : values_of(document)) {
        if (place.way.empty() || !seen.insert(place.name).second) continue;
        std::vector<std::string> above = place.way;
        above.pop_back();
        json changed = document;
        json& parent = at_place(changed, above);
        if (!parent.is_object()) continue;
        parent.erase(place.way.back());
        const std::vector<Finding> findings = subject.findings(changed);
        INFO(subject.name << " " << place.name << "\n" << text_of(findings));
        if (findings.empty()) CHECK(check.complaints(changed) == "");
        if (!check.accepts(changed)) ++required;
      }
    }
  }
  CHECK(required > 100);
}

TEST_CASE("a quantity of a schema takes the units of its dimension and the reader's numbers") {
  using io::Dimension;
  const std::map<std::string, std::vector<Dimension>> kQuantities{
      {"angle", {Dimension::Angle}},
      {"angular_velocity", {Dimension::AngularVelocity}},
      {"length", {Dimension::Length}},
      {"velocity", {Dimension::Velocity}},
      {"joint_position", {Dimension::JointPosition}},
      {"mass", {Dimension::Mass}},
      {"inertia", {Dimension::Inertia}},
      {"time", {Dimension::Time}},
      {"rate", {Dimension::Rate}},
      {"moment", {Dimension::Moment}},
      {"impulse", {Dimension::Impulse}},
      {"angular_impulse", {Dimension::AngularImpulse}},
      {"linear_stiffness", {Dimension::LinearStiffness}},
      {"linear_damping", {Dimension::LinearDamping}},
      {"joint_velocity", {Dimension::AngularVelocity, Dimension::Velocity}},
      {"joint_acceleration", {Dimension::AngularAcceleration, Dimension::Acceleration}},
      {"joint_inertia", {Dimension::Inertia, Dimension::Mass}},
      {"joint_stiffness", {Dimension::Stiffness, Dimension::LinearStiffness}},
      {"joint_damping", {Dimension::Damping, Dimension::LinearDamping}}};
  std::set<std::string> units{"parsec", "M", "rad s"};
  for (int d = 0; d <= static_cast<int>(Dimension::LinearDamping); ++d) {
    std::istringstream list(io::units_of(static_cast<Dimension>(d)));
    for (std::string unit; std::getline(list, unit, ',');) {
      units.insert(unit.substr(unit.find_first_not_of(' ')));
    }
  }
  CHECK(units.size() > 30);
  const json whole = schema("problem");
  std::set<std::string> used;
  for (const auto& [name, definition] : whole.at("definitions").items()) {
    const json& kinds = definition.value("anyOf", json::array());
    if (kinds.size() != 2 || !kinds[1].contains("pattern")) continue;
    used.insert(name);
    INFO(name);
    REQUIRE(kQuantities.count(name) == 1);
    SchemaCheck check(definition);
    for (const std::string& unit : units) {
      bool fits = false;
      for (const Dimension d : kQuantities.at(name)) fits = fits || io::unit_factor(unit, d);
      INFO(unit);
      CHECK(check.accepts("-1.5 " + unit) == fits);
    }
  }
  CHECK(used.size() == kQuantities.size());

  SchemaCheck length(whole.at("definitions").at("length")),
      moment(whole.at("definitions").at("angular_impulse"));
  for (const char* text :
       {"1 m",         "+1 m",       "-1 m",   "1. m",  ".5 m", "5e3 m", "5e-3 m", "1E+2 m",
        "0 m",         "0.1 m",      "00.1 m", "01 m",  "1m",   " 1 m",  "1 m ",   "1  m",
        "1 m m",       "- 1 m",      "+-1 m",  "--1 m", "1e m", "e3 m",  ". m",    "1,5 m",
        "0x10 m",      "inf m",      "nan m",  "1",     "",     "m",     "1 M",    "1 N m s",
        "1 N  m   s ", "1 N m  s s", "1 Nm s", "1\tm",  "1 m\n"}) {
    INFO("'" << text << "'");
    for (const auto& [check, dimension] :
         {std::pair(&length, Dimension::Length), std::pair(&moment, Dimension::AngularImpulse)}) {
      io::ReadContext context{"x", {}, {}};
      io::Node node;
      node.kind = io::Node::Kind::Quoted;
      node.text = text;
      CHECK(check->accepts(text) == io::read_number(context, node, "x", dimension).has_value());
    }
  }
}

TEST_CASE("the problem's schema says of every field what the table of fields says") {
  const SchemaPlaces places = places_of(schema("problem"));
  std::istringstream lines(file_text(source_path("problems/README.md")));
  int rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| `", 0) != 0 && line.rfind("| **`", 0) != 0) continue;
    std::vector<std::string> cells;
    std::istringstream parts(line.substr(2));
    for (std::string cell; std::getline(parts, cell, '|');) {
      const std::size_t begin = cell.find_first_not_of(' ');
      cells.push_back(begin == std::string::npos
                          ? ""
                          : cell.substr(begin, cell.find_last_not_of(' ') - begin + 1));
    }
    REQUIRE(cells.size() == 4);
    const std::size_t begin = cells[0].find('`') + 1;
    const std::string field = cells[0].substr(begin, cells[0].find('`', begin) - begin);
    if (field == "format" || field == "version") continue;
    std::string words = cells[1];
    if (!cells[2].empty()) words += (words.empty() ? "[" : " [") + cells[2] + "]";
    if (!cells[3].empty() && cells[3] != "required") {
      words += (words.empty() ? "default: " : "; default: ") + cells[3];
    }
    INFO(field);
    if (!words.empty()) {
      REQUIRE(places.descriptions.count(field) == 1);
      INFO(*places.descriptions.at(field).begin());
      CHECK(places.descriptions.at(field).count(words) == 1);
    }
    ++rows;
  }
  CHECK(rows > 90);
}
