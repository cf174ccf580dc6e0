// docs/plan-members.md against the tool that prints it, the schema of plan files, and plans.
#include <catch2/catch.hpp>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include <stillbase/core/file.hpp>
#include <stillbase/io/schema.hpp>

#include "io/schema_subjects.hpp"
#include "support/temporary_folder.hpp"

namespace stillbase {
namespace {

using Json = nlohmann::json;
using Members = std::set<std::string>;

/// Members whose own content is described elsewhere, or has names of its own as keys.
bool is_described_as_a_whole(const std::string& member) {
  static const Members kWhole{"tool", "problem", "verification", "solver_calls", "timing"};
  const bool is_pose = member.size() > 9 && member.compare(member.size() - 9, 9, "base_pose") == 0;
  const bool is_per_joint = member.rfind("impact.joint_resistance_values.", 0) == 0;
  return kWhole.count(member) > 0 || is_pose || is_per_joint || member == "approach.base_poses" ||
         member == "approach.abort.base_poses";
}

constexpr const char* kPage = STILLBASE_SOURCE_DIR "/docs/plan-members.md";

/// First cells of the page's table, with the second ones: what they mean.
std::map<std::string, std::string> documented_meanings() {
  std::istringstream lines(read_text_file(kPage));
  std::map<std::string, std::string> meanings;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| `", 0) != 0) continue;
    const std::size_t end = line.find("` | "), next = line.find(" | ", end + 4);
    REQUIRE(next != std::string::npos);
    const bool is_new =
        meanings.emplace(line.substr(3, end - 3), line.substr(end + 4, next - end - 4)).second;
    INFO(line);
    CHECK(is_new);
  }
  return meanings;
}

Members documented_members() {
  Members members;
  for (const auto& [member, meaning] : documented_meanings()) members.insert(member);
  return members;
}

/// Members that a schema permits, "a.b" and "list[].c".
void add_schema_members(const Json& schema, const Json& definitions, const std::string& path,
                        Members& members) {
  if (schema.contains("$ref")) {
    const std::string name = schema.at("$ref").get<std::string>().substr(14);  // #/definitions/
    return add_schema_members(definitions.at(name), definitions, path, members);
  }
  for (const char* key : {"allOf", "anyOf", "oneOf"}) {
    for (const Json& part : schema.value(key, Json::array())) {
      add_schema_members(part, definitions, path, members);
    }
  }
  if (schema.contains("items")) {
    add_schema_members(schema.at("items"), definitions, path + "[]", members);
  }
  const Json properties = schema.value("properties", Json::object());  // items() only refers to it
  for (const auto& [key, value] : properties.items()) {
    const std::string member = path.empty() ? key : path + "." + key;
    members.insert(member);
    if (!is_described_as_a_whole(member)) {
      add_schema_members(value, definitions, member, members);
    }
  }
}

/// Members that a plan has.
void add_plan_members(const Json& value, const std::string& path, Members& members) {
  if (is_described_as_a_whole(path)) return;
  if (value.is_array()) {
    for (const Json& item : value) add_plan_members(item, path + "[]", members);
  }
  if (!value.is_object()) return;
  for (const auto& [key, item] : value.items()) {
    const std::string member = path.empty() ? key : path + "." + key;
    members.insert(member);
    add_plan_members(item, member, members);
  }
}

}  // namespace

TEST_CASE("the page of a plan's members is what the table of its fields prints") {
  const TemporaryFolder folder;
  const std::string printed = folder.path("plan-members.md");
  const std::string command = STILLBASE_TOOL " schema plan --fields -o " + printed;
  REQUIRE(std::system(command.c_str()) == 0);
  // After a change: stillbase schema plan --fields -o docs/plan-members.md --force
  CHECK(read_text_file(printed) == read_text_file(kPage));
}

TEST_CASE("the page of a plan's members says what each of them means") {
  for (const auto& [member, meaning] : documented_meanings()) {
    INFO(member);
    CHECK(meaning.find_first_not_of(' ') != std::string::npos);
  }
}

TEST_CASE("the page of a plan's members lists those that plans have, and no others") {
  Members members{"verification"};  // `verify -o` enters it
  for (const Json& plan : io_test::plan_subject().documents) add_plan_members(plan, "", members);
  CHECK(documented_members() == members);
}

TEST_CASE("the page of a plan's members and the schema list the same ones") {
  const Json schema = Json::parse(schema_of("plan"));
  Members members;
  add_schema_members(schema, schema.at("definitions"), "", members);
  CHECK(documented_members() == members);
}

TEST_CASE("the page of a plan's members lists every one of a written plan") {
  const TemporaryFolder folder;
  const Members documented = documented_members();
  for (const char* problem : {"planar_two_link_c2_a", "planar_three_link_client"}) {
    const std::string plan = folder.path(std::string(problem) + ".json");
    const std::string command = STILLBASE_TOOL " plan " STILLBASE_SOURCE_DIR "/problems/" +
                                std::string(problem) + ".yaml -o " + plan + " 2>/dev/null";
    REQUIRE(std::system(command.c_str()) == 0);
    Members members;
    add_plan_members(Json::parse(read_text_file(plan)), "", members);
    CHECK(members.size() > 80);
    for (const std::string& member : members) {
      INFO(member);
      CHECK(documented.count(member) == 1);
    }
  }
}

}  // namespace stillbase
