// What the program writes against the schemas that it prints.
#include <catch2/catch.hpp>

#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include <stillbase/plan/quantities.hpp>

#include "cli/tool.hpp"
#include "support/schema_check.hpp"

using namespace stillbase::cli_test;
using namespace stillbase::test;

namespace {

std::string quoted(const std::string& path) { return "'" + path + "'"; }

std::string shipped(const std::string& name) {
  return quoted(source_path("problems/" + name + ".yaml"));
}

/// Documents of one format against its schema: each is accepted, and between them they use every
/// key but the named ones.
void require_fit(const Workshop& shop, const std::string& format,
                 const std::vector<json>& documents, const std::set<std::string>& unused = {}) {
  const Outcome printed = shop.run("schema " + format);
  INFO(format << printed.err);
  REQUIRE(printed.code == 0);
  const json schema = json::parse(printed.out);
  SchemaCheck check(schema);
  std::set<std::string> used;
  const std::set<std::string> all = places_of(schema).all;
  for (const json& document : documents) {
    INFO(document.dump().substr(0, 200));
    CHECK(check.complaints(document) == "");
    for (const Place& place : values_of(document)) used.insert(place.name);
    json stranger = document;
    stranger["zzz"] = 1;
    CHECK_FALSE(check.accepts(stranger));
  }
  for (const std::string& place : all) {
    if (place.back() == '*' || place.find('*') != std::string::npos) continue;  // any name
    INFO("in the schema: " << place);
    CHECK((used.count(place) == 1) != (unused.count(place) == 1));
  }
}

/// Places of a format below this key.
std::set<std::string> places_below(const Workshop& shop, const std::string& format,
                                   const std::string& key) {
  std::set<std::string> out;
  const std::string parts = "." + key + ".";
  for (const std::string& place : places_of(json::parse(shop.run("schema " + format).out)).all) {
    if (("." + place + ".").find(parts) != std::string::npos) out.insert(place);
  }
  return out;
}

json output(const Outcome& outcome) {
  INFO(outcome.err);
  REQUIRE_FALSE(outcome.out.empty());
  return json::parse(outcome.out);
}

}  // namespace

TEST_CASE("schema prints the schema of a format, or names them all") {
  const Workshop shop;
  const Outcome list = shop.run("schema");
  CHECK(list.code == 0);
  for (const char* name : {"problem", "target", "state", "plan", "verification", "analysis",
                           "suite", "campaign", "simulation", "pareto"}) {
    INFO(name);
    CHECK(("\n" + list.out).find("\n" + std::string(name) + " ") != std::string::npos);
    CHECK(json::parse(shop.run(std::string("schema ") + name).out).contains("properties"));
  }
  CHECK(shop.run("schema problem -o problem.schema.json").code == 0);
  CHECK(shop.text("problem.schema.json") == shop.run("schema problem").out);
  CHECK(shop.run("schema problem -o problem.schema.json").code == 7);
  const Outcome wrong = shop.run("schema poem");
  CHECK(wrong.code == 2);
  CHECK(wrong.says("no format 'poem'; there are analysis"));
  CHECK(shop.run("schema definitions").code == 2);
  CHECK(shop.run("schema -o all.json").code == 2);
}

TEST_CASE("schema --fields prints the fields of one format, or of all that people write") {
  const Workshop shop;
  const std::string all = shop.run("schema --fields").out;
  CHECK(all.find("\n## problem\n") != std::string::npos);
  CHECK(all.find("\n## plan\n") == std::string::npos);
  const std::string plan = shop.run("schema plan --fields").out;
  CHECK(plan.find("\n## plan\n") != std::string::npos);
  CHECK(plan.find("\n## problem\n") == std::string::npos);
  CHECK(plan.find("| `approach.joint_positions` | per sample | k x n | rad (m) |") !=
        std::string::npos);
  CHECK(shop.run("schema poem --fields").code == 2);
}

TEST_CASE("plans, verdicts and campaigns are what their schemas say") {
  const Workshop shop;
  REQUIRE(shop.run("plan " + shipped("planar_two_link_c2_a") + " -o plan.json").code == 0);
  const json plan = json::parse(shop.text("plan.json"));
  CHECK(SchemaCheck(json::parse(shop.run("schema plan").out)).complaints(plan) == "");
  // The copy of the problem is a problem.
  CHECK(SchemaCheck(json::parse(shop.run("schema problem").out)).complaints(plan.at("problem")) ==
        "");

  CHECK(shop.run("verify plan.json --trials 8 -o verdict.json").code == 0);
  json cut = json::parse(shop.text("verdict.json"));
  cut["interrupted"] = true;
  // Trials of a target whose estimate has a covariance, with a posture error.
  shop.write_changed("client.yaml", "problems/ets7_client.yaml", "confidence: 0.95",
                     "confidence: 0.95\n  joint_position: 0.1 deg");
  REQUIRE(shop.run("plan client.yaml -o client.json").code == 0);
  CHECK(shop.run("verify client.json --trials 2 -o client_verdict.json").code == 0);
  require_fit(
      shop, "verification",
      {json::parse(shop.text("verdict.json")), json::parse(shop.text("client_verdict.json")), cut},
      places_below(shop, "verification", "residual_velocity"));
  json with_verdict = plan;
  with_verdict["verification"] = cut;
  CHECK(SchemaCheck(json::parse(shop.run("schema plan").out)).complaints(with_verdict) == "");

  shop.write("problem.yaml", file_text(source_path("problems/planar_two_link_c2_a.yaml")));
  shop.write("spec.yaml",
             "format: stillbase.campaign\nversion: 1\nplans: [plan.json, "
             "client.json]\nproblems: [problem.yaml]\ntrials: 4\n");
  REQUIRE(shop.run("campaign make spec.yaml -o cases.jsonl").code == 0);
  REQUIRE(shop.run("campaign run cases.jsonl --jobs 2 -o A").code == 0);
  REQUIRE(shop.run("campaign merge A -o whole.json").code == 0);
  // Cases that do not end in time.
  REQUIRE(shop.run("campaign run cases.jsonl -o B --case-limit 0.001").code == 0);
  REQUIRE(shop.run("campaign merge B -o part.json").code == 0);
  require_fit(shop, "campaign_result",
              {json::parse(shop.text("whole.json")), json::parse(shop.text("part.json"))},
              places_below(shop, "campaign_result", "residual_velocity"));
}

TEST_CASE("analyses and inspections are what their schemas say") {
  const Workshop shop;
  const std::string analyze = "analyze " + shipped("planar_two_link_sweep_a") + " --json";
  const std::string servo = "impact.joint_resistance_values.";
  std::set<std::string> unused;
  for (const char* row : {"rows[]", "joint_resistances[]"}) {
    if (row[0] == 'r') unused.insert("rows[].illustrative");
    for (const char* key :
         {"contact_duration", "damping", "locked", "rotor_inertia", "stiffness"}) {
      if (row[0] == 'r') unused.insert(std::string(row) + ".joint_resistance_values." + key);
    }
  }
  unused.insert("joint_resistances[].direction_deg");
  unused.merge(places_below(shop, "analysis", "before"));  // of a hand that moves
  require_fit(shop, "analysis",
              {output(shop.run(analyze)), output(shop.run(analyze + " --sweep-direction 4"))},
              unused);
  shop.write("state.json", R"({"joint_positions": [0.1, -0.2], "impulse": {"force": [1, 2, 0]}})");
  const std::string inspect = "inspect robots/planar_two_link_a.urdf --json";
  unused.clear();
  for (const char* key : {"contact_duration", "damping", "locked", "rotor_inertia", "stiffness"}) {
    unused.insert(servo + key);
  }
  unused.merge(places_below(shop, "inspection", "before"));
  require_fit(shop, "inspection",
              {output(shop.run(inspect)), output(shop.run(inspect + " --state state.json"))},
              unused);
}

TEST_CASE("predictions are what their schema says") {
  const Workshop shop;
  const std::string range = " --from 0 --to 2 --step 1 --json";
  require_fit(shop, "prediction",
              {output(shop.run("predict " + shipped("ets7_client") + range)),
               output(shop.run("predict " + shipped("iiwa_client_50") + range))},
              // Other forms of an attitude are for files that people write.
              {"instants[].orientation.angle", "instants[].orientation.axis",
               "instants[].orientation.rpy"});
}

TEST_CASE("updates of a plan are what their schema says") {
  const Workshop shop;
  shop.write_changed("client.yaml", "problems/iiwa_client_50.yaml", "approach:\n",
                     "approach:\n  enabled: false\n");
  REQUIRE(shop.run("plan client.yaml --starts 4 -o plan.json").code == 0);
  const std::string stream = file_text(source_path("problems/streams/iiwa_client_50.csv"));
  const std::size_t first = stream.find("\n0,") + 1, second = stream.find('\n', first) + 1;
  const std::string row = stream.substr(first, second - first);
  // The second estimate is of a time after the contact.
  shop.write("stream.csv", stream.substr(0, second) + "80" + row.substr(1));
  const Outcome played = shop.run("replan plan.json --estimates stream.csv --timing --json");
  CHECK(played.code == 4);
  // Only of a last posture that is feasible the time after the impact is said.
  shop.write("first.csv", stream.substr(0, second));
  const Outcome first_alone = shop.run("replan plan.json --estimates first.csv --json");
  require_fit(shop, "replan", {output(played), output(first_alone)});
}

TEST_CASE("simulations and contact tables are what their schemas say") {
  const Workshop shop;
  shop.write_changed("soft.yaml", "problems/iiwa_client_50.yaml", "post_impact:\n",
                     "post_impact:\n  contact: {model: compliant, friction: 0.1}\n");
  require_fit(
      shop, "simulation",
      {output(shop.run("simulate soft.yaml --controller rns_damped --json")),
       output(shop.run("simulate " + shipped("servicer_latch") +
                       " --controller joint_damping --json")),
       output(shop.run("simulate " + shipped("planar_two_link_post_impact_a") + " --json"))});
  require_fit(shop, "contact_table",
              {output(shop.run("simulate soft.yaml --contact-table --servo 200 5 --json"))});
}

TEST_CASE("fronts and benchmarks are what their schemas say") {
  const Workshop shop;
  REQUIRE(shop.run("plan " + shipped("planar_three_link_null") +
                   " --starts 8 --pareto base_angular_momentum,joint_rate_norm -o front.json")
              .code == 0);
  std::set<std::string> others;
  for (const stillbase::QuantityRow& row : stillbase::quantities()) {
    const std::string quantity = row.name;
    const bool is_asked_for = quantity == "base_angular_momentum" || quantity == "joint_rate_norm";
    if (!is_asked_for) others.insert("points[]." + quantity);
  }
  require_fit(shop, "pareto", {json::parse(shop.text("front.json"))}, others);
  REQUIRE(shop.run("bench --suite " + quoted(source_path("bench/suite.yaml")) +
                   " --select planar_two_link/case/0 --seeds 1 --budget 100 --optimizers "
                   "nlopt-slsqp -o B")
              .code == 0);
  require_fit(shop, "bench", {json::parse(shop.text("B/bench.json"))});
}
