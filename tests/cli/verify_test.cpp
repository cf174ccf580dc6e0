#include <catch2/catch.hpp>

#include <cstdio>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::ordered_json;

namespace {

const ordered_json& claim_of(const ordered_json& verification, const std::string& name) {
  for (const ordered_json& claim : verification.at("claims")) {
    if (claim.at("name") == name) return claim;
  }
  throw std::logic_error("no claim " + name);
}

/// The text of a shipped problem with parts replaced, each where it first occurs.
std::string altered(const std::string& problem,
                    const std::vector<std::pair<std::string, std::string>>& parts) {
  std::string text = file_text(source_path("problems/" + problem + ".yaml"));
  for (const auto& [from, to] : parts) {
    const std::size_t at = text.find(from);
    if (at == std::string::npos) throw std::logic_error("nothing to replace: " + from);
    text.replace(at, from.size(), to);
  }
  return text;
}

}  // namespace

TEST_CASE(
    "a plan as it was written passes, a changed one fails by its fingerprint and its checks") {
  const Workshop shop;
  const std::string problem = source_path("problems/planar_two_link_c2_a.yaml");
  REQUIRE(shop.run("plan '" + problem + "' -o plan.json").code == 0);

  const Outcome good = shop.run("verify plan.json -o verification.json");
  INFO(good.err);
  CHECK(good.code == 0);
  CHECK(good.out.empty());
  CHECK(good.says("verdict: pass"));
  CHECK(good.says("(norm; the fastest joint reached"));
  const ordered_json passed = ordered_json::parse(shop.text("verification.json"));
  ordered_json plan = ordered_json::parse(shop.text("plan.json"));
  CHECK(passed.at("format") == "stillbase.verification");
  CHECK(passed.at("verdict") == "pass");
  CHECK(passed.at("content_sha256") == plan.at("content_sha256"));
  std::set<std::string> names;
  for (const ordered_json& claim : passed.at("claims")) {
    INFO(claim.dump());
    // What only the search knows is neither confirmed nor refuted.
    CHECK((claim.at("pass") == true ||
           (claim.at("group") == "search_record" && claim.at("pass").is_null())));
    CHECK(names.insert(claim.at("name").get<std::string>()).second);
  }

  // Without -o the same goes to stdout; an existing file is not replaced.
  CHECK(ordered_json::parse(shop.run("verify plan.json").out) == passed);
  CHECK(shop.run("verify plan.json -o verification.json").code == 7);

  double& phi = plan.at("configuration").at("joint_positions").at(0).get_ref<double&>();
  phi += 1e-3;
  shop.write("changed.json", plan.dump());
  const Outcome bad = shop.run("verify changed.json");
  CHECK(bad.code == 5);
  CHECK(bad.says("FAILED"));
  CHECK(bad.says("verdict: FAIL"));
  const ordered_json failed = ordered_json::parse(bad.out);
  CHECK(failed.at("verdict") == "fail");
  CHECK_FALSE(claim_of(failed, "content_fingerprint").at("pass").get<bool>());
  CHECK(claim_of(failed, "robot_fingerprint").at("pass").get<bool>());
  int others = 0;
  for (const ordered_json& claim : failed.at("claims")) {
    if (claim.at("pass") == false) ++others;
  }
  CHECK(others > 1);
}

TEST_CASE("audit checks the search record alone, verify the plan and its search record") {
  const Workshop shop;
  const std::string problem = source_path("problems/planar_two_link_c2_a.yaml");
  REQUIRE(shop.run("plan '" + problem + "' -o plan.json").code == 0);
  const auto groups = [](const ordered_json& verification) {
    std::set<std::string> out;
    for (const ordered_json& claim : verification.at("claims"))
      out.insert(claim.at("group").get<std::string>());
    return out;
  };
  const Outcome good = shop.run("audit plan.json -o audit.json");
  INFO(good.err);
  CHECK(good.code == 0);
  CHECK(good.says("audit checks hold"));
  const ordered_json audit = ordered_json::parse(shop.text("audit.json"));
  CHECK(groups(audit) == std::set<std::string>{"inputs", "audit", "search_record"});
  const ordered_json verification = ordered_json::parse(shop.run("verify plan.json").out);
  CHECK(groups(verification) == std::set<std::string>{"inputs", "physics", "constraints",
                                                      "approach", "after_contact", "audit",
                                                      "search_record"});
  for (const ordered_json& claim : audit.at("claims")) {
    CHECK(claim_of(verification, claim.at("name").get<std::string>()) == claim);
  }

  ordered_json plan = ordered_json::parse(shop.text("plan.json"));
  plan.at("certificate").at("distinct_solutions") = 9;
  shop.write("changed.json", plan.dump());
  const Outcome bad = shop.run("audit changed.json");
  CHECK(bad.code == 5);
  CHECK(claim_of(ordered_json::parse(bad.out), "candidates_list").at("pass") == false);
}

TEST_CASE("a repeated search confirms the record of a plan, and refutes an altered one") {
  const Workshop shop;
  const std::string problem = source_path("problems/planar_two_link_c2_a.yaml");
  REQUIRE(shop.run("plan '" + problem + "' -o plan.json").code == 0);
  const ordered_json once = ordered_json::parse(shop.run("verify plan.json").out);
  CHECK(claim_of(once, "search_counts").at("pass").is_null());
  const Outcome good = shop.run("verify plan.json --rerun");
  INFO(good.err);
  CHECK(good.code == 0);
  const ordered_json again = ordered_json::parse(good.out);
  CHECK(claim_of(again, "search_repeated").at("pass") == true);
  CHECK(claim_of(again, "search_counts").at("pass") == true);

  ordered_json plan = ordered_json::parse(shop.text("plan.json"));
  plan.at("certificate").at("starts") = plan.at("certificate").at("starts").get<int>() + 1;
  shop.write("changed.json", plan.dump());
  const Outcome bad = shop.run("audit changed.json --rerun");
  CHECK(bad.code == 5);
  const ordered_json claim = claim_of(ordered_json::parse(bad.out), "search_repeated");
  CHECK(claim.at("pass") == false);
  CHECK(claim.at("detail").get<std::string>().find("certificate") != std::string::npos);
}

TEST_CASE("a healthy plan's summary names what only the search knows in one line") {
  const Workshop shop;
  const std::string problem = source_path("problems/planar_two_link_c2_a.yaml");
  REQUIRE(shop.run("plan '" + problem + "' -o plan.json").code == 0);
  const auto lines_with = [](const Outcome& outcome, const std::string& word) {
    int count = 0;
    std::istringstream lines(outcome.err);
    for (std::string line; std::getline(lines, line);) {
      if (line.find(word) != std::string::npos) ++count;
    }
    return count;
  };
  const Outcome brief = shop.run("verify plan.json");
  INFO(brief.err);
  CHECK(lines_with(brief, " open ") == 1);
  CHECK(brief.says(" open  search record: search_counts, "));
  CHECK(brief.says("not verified (the search's own record)"));
  CHECK_FALSE(brief.says("could not be checked"));
  CHECK_FALSE(brief.says("certificate.distinct_solutions"));

  const Outcome full = shop.run("verify plan.json --all");
  INFO(full.err);
  CHECK(full.says("certificate.distinct_solutions"));
  CHECK(lines_with(full, " open ") >= 2);

  // Repeated, everything is checked.
  const Outcome repeated = shop.run("audit plan.json --rerun");
  INFO(repeated.err);
  CHECK(lines_with(repeated, " open ") == 0);
  CHECK_FALSE(repeated.says("not verified"));

  // What could not be compared for another reason is still said in full.
  shop.write("own.yaml", file_text(problem));
  REQUIRE(shop.run("plan own.yaml -o own.json").code == 0);
  std::filesystem::remove(shop.path("own.yaml"));
  const Outcome alone = shop.run("verify own.json");
  INFO(alone.err);
  CHECK(alone.says("inputs_unchanged"));
  CHECK(alone.says(", 1 could not be checked, "));
  CHECK(lines_with(alone, " open ") == 2);
}

TEST_CASE("without the problem file the verdict says what the plan was compared with") {
  const Workshop shop;
  shop.write("own.yaml", file_text(source_path("problems/planar_two_link_c2_a.yaml")));
  REQUIRE(shop.run("plan own.yaml -o plan.json").code == 0);
  CHECK_FALSE(shop.run("verify plan.json").says("the plan's own copy of the problem"));
  std::filesystem::remove(shop.path("own.yaml"));
  const Outcome alone = shop.run("verify plan.json");
  CHECK(alone.code == 0);
  CHECK(alone.says("against the plan's own copy of the problem"));
  CHECK(claim_of(ordered_json::parse(alone.out), "inputs_unchanged").at("pass").is_null());
}

TEST_CASE("a plan whose whole momentum vanishes verifies, and needs no time of the wheels") {
  const Workshop shop;
  shop.write(
      "problem.yaml",
      altered("matched_light",
              {{"  contact: latch\n", "  contact: normal\n"},
               {"contact:\n  hand_velocity: match_all\n  arrival_rates: least_joint_rate\n", ""},
               {"objective: base_angular_momentum", "objective: total_angular_momentum"},
               {"controllers: [rns_damped,",
                "wheels: {torque: 0.2, capacity: 4}\n  controllers: [detumble, rns_damped,"}}));
  const Outcome plan = shop.run("plan problem.yaml --starts 8 -o plan.json");
  INFO(plan.err);
  REQUIRE(plan.code == 0);
  CHECK_FALSE(plan.says("the wheels alone need"));
  const auto managed = nlohmann::json::parse(shop.text("plan.json")).at("managed_momentum");
  CHECK(managed.at("least_time") == 0);
  const Outcome verdict = shop.run("verify plan.json -o verdict.json");
  INFO(verdict.err);
  CHECK(verdict.code == 0);
}

TEST_CASE("the summary says how far a hand that stopped is from the feature, and for how long") {
  const Workshop shop;
  shop.write("problem.yaml", altered("matched_light", {}));
  const Outcome plan = shop.run("plan problem.yaml --starts 8 -o plan.json");
  INFO(plan.err);
  REQUIRE(plan.code == 0);
  const Outcome verdict = shop.run("verify plan.json -o verdict.json");
  REQUIRE(verdict.code == 0);
  // By the dynamics of the verification.
  const auto verification = ordered_json::parse(shop.text("verdict.json"));
  char distance[32];
  std::snprintf(distance, sizeof distance, "%.3g",
                claim_of(verification, "abort_distance").at("value").get<double>());
  CHECK(plan.says(std::string("if the grasp does not close, ") + distance +
                  " m from the plane of the feature, which reaches the hand "));
}

TEST_CASE("a case of a sticking contact has the two equations that its force leaves open") {
  const Workshop shop;
  shop.write("problem.yaml",
             altered("iiwa_case_c", {{"  restitution: 0.2\n", "  contact: sticking\n"},
                                     {"measure: worst_case", "measure: nominal"},
                                     {"cone_half_angle: 10 deg", "cone_half_angle: 0 deg"}}));
  const Outcome plan = shop.run("plan problem.yaml --starts 8 -o plan.json");
  INFO(plan.err);
  REQUIRE(plan.code == 0);
  const Outcome verdict = shop.run("verify plan.json -o verdict.json");
  INFO(verdict.err);
  CHECK(verdict.code == 0);
}

TEST_CASE("verify refuses what is no plan") {
  const Workshop shop;
  shop.write("not.json", "{\"format\": \"stillbase.plan\"");
  CHECK(shop.run("verify not.json -o out.json").code == 3);
  shop.write("other.json", "{\"format\": \"stillbase.state\", \"version\": 1}");
  const Outcome outcome = shop.run("verify other.json -o out.json");
  CHECK(outcome.code == 3);
  CHECK(outcome.says("other.json:1: "));
  CHECK_FALSE(shop.has("out.json"));
}

TEST_CASE("report refuses a verdict against its own checks, and one of another plan") {
  const Workshop shop;
  const std::string problem = source_path("problems/planar_two_link_c2_a.yaml");
  REQUIRE(shop.run("plan '" + problem + "' -o plan.json").code == 0);
  REQUIRE(shop.run("plan '" + problem + "' -o other.json --seed 7").code == 0);
  REQUIRE(shop.run("verify plan.json -o verdict.json").code == 0);
  CHECK(shop.run("report plan.json verdict.json -o a.html").code == 0);
  CHECK(shop.run("report verdict.json -o b.html").code == 0);

  const Outcome foreign = shop.run("report other.json verdict.json -o c.html");
  CHECK(foreign.code == 3);
  CHECK(foreign.says("other-plan: content_sha256"));
  CHECK_FALSE(shop.has("c.html"));

  const ordered_json verdict = ordered_json::parse(shop.text("verdict.json"));
  ordered_json lie = verdict;
  lie.at("claims").at(0).at("pass") = false;
  shop.write("lie.json", lie.dump());
  for (const std::string files : {"lie.json", "plan.json lie.json"}) {
    const Outcome refused = shop.run("report " + files + " -o d.html");
    CHECK(refused.code == 3);
    CHECK(refused.says("contradiction: verdict"));
  }
  ordered_json reversed = verdict;
  reversed.at("verdict") = "fail";
  shop.write("reversed.json", reversed.dump());
  CHECK(shop.run("report reversed.json -o e.html").code == 3);
  // Entered into the plan it is judged alike.
  ordered_json plan = ordered_json::parse(shop.text("plan.json"));
  plan["verification"] = verdict;
  shop.write("with.json", plan.dump());
  CHECK(shop.run("report with.json -o f.html").code == 0);
  plan["verification"] = lie;
  shop.write("with.json", plan.dump());
  CHECK(shop.run("report with.json -o g.html").code == 3);
}

TEST_CASE("plans as they were written pass, whatever their problem states") {
  const Workshop shop;
  const auto verdict = [&](const std::string& problem,
                           const std::vector<std::pair<std::string, std::string>>& parts,
                           const std::string& options = "") {
    shop.write("problem.yaml", altered(problem, parts));
    const Outcome plan = shop.run("plan problem.yaml -o plan.json --force" + options);
    INFO(plan.err);
    REQUIRE(plan.code == 0);
    const Outcome verified = shop.run("verify plan.json");
    INFO(verified.err);
    CHECK(verified.code == 0);
    return ordered_json::parse(verified.out);
  };
  SECTION("a name that is not that of the file") {
    const auto passed =
        verdict("planar_two_link_c2_a", {{"version: 1\n", "version: 1\nname: my_capture\n"}});
    CHECK(claim_of(passed, "inputs_unchanged").at("pass") == true);
    ordered_json plan = ordered_json::parse(shop.text("plan.json"));
    plan["problem"]["name"] = "problem";
    shop.write("other.json", plan.dump());
    const auto other = ordered_json::parse(shop.run("verify other.json").out);
    CHECK_THAT(claim_of(other, "inputs_unchanged").at("detail").get<std::string>(),
               Catch::Contains("the problem's name is problem, not my_capture"));
  }
  SECTION("a momentum about an axis without a wheel") {
    verdict("servicer_handback",
            {{"  wheel_torque: 0.2 N m\n  wheel_momentum: 4 N m s\n",
              "  wheels: {torque: [0, 1, 0]}\n"},
             {"  thrusters: {torque: 1 N m, gain: 0.5 1/s, dead_band: 0.02 deg/s}\n", ""}});
    CHECK(shop.text("plan.json").find("and there is no wheel about") != std::string::npos);
  }
  SECTION("an objective that is zero in every posture") {
    verdict("planar_three_link_client",
            {{"joint_resistance: free", "joint_resistance: {model: locked, locked: all}"},
             {"quantity: base_angular_momentum", "quantity: joint_rate_norm"}},
            " --starts 8");
  }
}
