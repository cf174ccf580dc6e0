// The schemas by themselves, and against the files and the table of fields that users read.
#include <functional>
#include <map>
#include <set>
#include <sstream>

#include <catch2/catch.hpp>

#include "io/field_reader.hpp"
#include "io/schema_support.hpp"
#include "io/units.hpp"

using namespace stillbase;
using namespace stillbase::io_test;
using namespace stillbase::test;

TEST_CASE("every schema stands alone and uses words of draft-07 that validators know") {
  static const std::set<std::string> kKnown{
      "$schema", "title", "description", "type", "required", "additionalProperties", "items",
      "minItems", "maxItems", "minimum", "exclusiveMinimum", "maximum", "pattern", "enum", "const",
      "anyOf", "allOf", "oneOf", "not", "$ref", "properties", "definitions", "uniqueItems",
      "minProperties", "maxProperties",
      // Annotations of our own: see members_of().
      "x-unit", "x-frame", "x-shape"};
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
      {"force", {Dimension::Force}},
      {"moment", {Dimension::Moment}},
      {"impulse", {Dimension::Impulse}},
      {"angular_impulse", {Dimension::AngularImpulse}},
      {"energy", {Dimension::Energy}},
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
  std::istringstream lines(problem_fields_text());
  int rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| `", 0) != 0) continue;
    std::vector<std::string> cells;
    std::istringstream parts(line.substr(2));
    for (std::string cell; std::getline(parts, cell, '|');) {
      const std::size_t begin = cell.find_first_not_of(' ');
      cells.push_back(begin == std::string::npos
                          ? ""
                          : cell.substr(begin, cell.find_last_not_of(' ') - begin + 1));
    }
    REQUIRE(cells.size() == 6);
    const std::string &unit = cells[3], &without = cells[5];
    const std::size_t begin = cells[0].find('`') + 1;
    const std::string field = cells[0].substr(begin, cells[0].find('`', begin) - begin);
    if (field == "format" || field == "version") continue;
    std::string words = cells[1];
    if (!unit.empty()) words += (words.empty() ? "[" : " [") + unit + "]";
    if (!without.empty() && without != "required") {
      const bool is_condition = without.rfind("required", 0) == 0;
      words += (words.empty() ? "" : "; ") + std::string(is_condition ? "" : "default: ") + without;
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
