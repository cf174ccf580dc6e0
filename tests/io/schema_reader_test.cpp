// The schemas and the hand-written readers say the same: what the readers take and refuse, the
// schemas take and refuse, as far as a schema can know.
#include <algorithm>
#include <optional>
#include <set>
#include <sstream>

#include <catch2/catch.hpp>

#include "io/schema_subjects.hpp"

using namespace stillbase;
using namespace stillbase::io_test;
using namespace stillbase::test;

namespace {

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
/// keys exclude each other: objective.quantity and terms, robot.file and robot.arms, the fields of
/// a term by its quantity, target.file and the fields of a target.
bool depends_on_others(const std::string& subject, const std::string& place) {
  static const std::set<std::string> kInPlans{"configuration",
                                              "candidates[]",
                                              "families[].points[]",
                                              "objective.nominal_optimum",
                                              "objective.terms",
                                              "impact.joint_resistance_values",
                                              "certificate.proof.solutions[]",
                                              "certificate.proof.undecided[]"};
  static const std::set<std::string> kInProblems{"objective", "objective.terms[]", "target",
                                                 "robot", "robot.base"};
  const bool is_copy = subject == "plan" && place.rfind("problem.", 0) == 0;
  return kInProblems.count(is_copy ? place.substr(8) : place) > 0 ||
         (subject == "plan" && kInPlans.count(place) > 0);
}

/// Orientations and geometries are the same everywhere: their part of a place's name, or all of it.
std::string shared_part(const std::string& place) {
  const std::string shape = "robot.base.shape.";
  if (const std::size_t at = place.find(shape); at != std::string::npos) {
    return "geometry." + place.substr(at + shape.size());
  }
  for (const char* value : {"orientation.", "geometry."}) {
    const std::size_t at = place.find(value);
    if (at != std::string::npos) return place.substr(at);
  }
  return place;
}

/// Name of a place of a document in the schema: objects in a map of names are "*" there.
std::string schema_name(const SchemaPlaces& places, const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos || places.all.count(name) > 0) return name;
  const std::string any = name.substr(0, dot) + ".*";
  return places.all.count(any) > 0 ? any : name;
}

}  // namespace

TEST_CASE("schemas and readers know the same keys") {
  std::set<std::string> reached;
  for (const Subject& subject : subjects()) {
    const json whole = schema(subject.name);
    const SchemaPlaces places = places_of(whole);
    SchemaCheck check(whole);
    // What was reached of shared values counts for all.
    for (auto place = reached.begin(); place != reached.end();) {
      const bool is_shared =
          starts_with(*place, "orientation.") || starts_with(*place, "geometry.");
      place = is_shared ? std::next(place) : reached.erase(place);
    }
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
        const std::string name = schema_name(places, place.name);
        if (!seen.insert(name + keys).second) continue;
        INFO("at '" << name << "'");
        const AllowedKeys allowed = keys_at(whole, document, place.way);
        object["zzz"] = 1;
        std::optional<std::set<std::string>> read;
        for (const Finding& finding : subject.findings(changed)) {
          if (finding.rule == "unknown-key") read = listed(finding.message, {"allowed"});
        }
        if (!read) {
          // Names of joints and the like.
          CHECK(allowed.any);
          reached.insert(shared_part(joined(name, "*")));
          continue;
        }
        CHECK_FALSE(allowed.any);
        CHECK_FALSE(check.accepts(changed));
        for (const std::string& key : *read) {
          INFO("read: " << key);
          CHECK(places.all.count(joined(name, key)) == 1);
          reached.insert(shared_part(joined(name, key)));
        }
        if (depends_on_others(subject.name, name)) continue;
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
      "variables.base_attitude", "variables.base_position", "objective", "impact.joint_resistance"};
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
  same("objective.measure", io::kMeasureNames);
  same("certificate.proof.status", io::proof_status_names());
  same("approach.status", io::approach_status_names());
  same("approach.polish.quantity", io::kPathPolishNames);
}

TEST_CASE("a schema accepts what the reader accepts, and refuses wrong types, units and ranges") {
  // What a schema cannot know: how many joints and families there are, what other fields ask for.
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
                     place.name != "candidates[].family" &&
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
