// Command lines and states that cannot be meant, and what a signal leaves behind.
#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::json;

namespace {

constexpr const char* kProblem = "problems/planar_two_link_c2_a.yaml";

/// Exit 2 with a reason, and nothing written.
void require_wrong_command_line(const Workshop& shop, const std::string& arguments,
                                const std::string& reason) {
  const Outcome outcome = shop.run(arguments);
  INFO(arguments << "\n" << outcome.err);
  CHECK(outcome.code == 2);
  CHECK(outcome.says(reason));
  CHECK(outcome.out.empty());
  CHECK_FALSE(shop.has("plan.json"));
}

}  // namespace

TEST_CASE("option values that mean nothing are refused") {
  const Workshop shop;
  shop.write("problem.yaml", file_text(source_path(kProblem)));
  const std::string plan = "plan problem.yaml -o plan.json ";
  for (const char* limit : {"nan", "inf", "-1", "0", "1e999", "ten", "1s"}) {
    require_wrong_command_line(shop, plan + "--time-limit " + limit, "--time-limit");
  }
  for (const char* seed : {"-1", "1.5", "1e3", "18446744073709551616", "+1", "0x1"}) {
    require_wrong_command_line(shop, plan + "--seed=" + seed, "--seed");
  }
  // An empty value is not one that was left out.
  for (const char* option : {"--optimizer", "--starts", "--seed", "--pareto", "--time-limit"}) {
    const std::string name = option;
    require_wrong_command_line(shop, plan + name + " ''", name + ": the value is empty");
    require_wrong_command_line(shop, plan + name + "=", name + "=: the value is empty");
  }
  for (const char* list : {"nlopt-slsqp,", ",ipopt", "nlopt-slsqp,,ipopt", ","}) {
    const std::string said = std::string("--optimizers ") + list + ": an element of the list";
    require_wrong_command_line(shop, std::string("bench problem.yaml --optimizers ") + list, said);
    require_wrong_command_line(shop, std::string("bench problem.yaml --optimizers=") + list, said);
  }
  require_wrong_command_line(shop, "plan problem.yaml -o ''", "empty");
  require_wrong_command_line(shop, "plan ''", "empty");
  require_wrong_command_line(shop, "inspect robots/iiwa_on_cube.urdf --hand ''", "empty");
  require_wrong_command_line(shop, "inspect robots/iiwa_on_cube.urdf --state ''", "empty");
}

TEST_CASE("the front of two quantities is that of one contact feature") {
  const Workshop shop;
  require_wrong_command_line(shop,
                             "plan " + source_path("problems/deos_features.yaml") +
                                 " -o plan.json --pareto base_angular_momentum,joint_rate_norm",
                             "variables.feature");
}

TEST_CASE("a front with the turn of the base needs to be told when") {
  const Workshop shop;
  require_wrong_command_line(
      shop,
      "plan " + source_path(kProblem) + " -o plan.json --pareto joint_rate_norm,attitude_turned",
      "'after'");
}

TEST_CASE("a front with an impulse that is zero in every posture is refused as in a problem") {
  const Workshop shop;
  for (const char* problem : {"problems/matched_medium.yaml", "problems/matched_residual.yaml"}) {
    for (const char* pair :
         {"impulse_magnitude,base_angular_momentum", "base_angular_momentum,impulse_magnitude"}) {
      require_wrong_command_line(
          shop, "plan " + source_path(problem) + " -o plan.json --pareto " + pair,
          "--pareto: impulse_magnitude: the impulse is zero in every posture");
    }
  }
}

TEST_CASE("a robot file in place of a problem is called what it is") {
  const Workshop shop;
  for (const char* command : {"plan", "predict --from 0 --to 1 --step 1"}) {
    INFO(command);
    const Outcome run = shop.run(std::string(command) + " robots/deos.urdf");
    INFO(run.err);
    CHECK(run.code != 0);
    CHECK(run.says("this is XML and neither YAML nor JSON"));
  }
}

TEST_CASE("detumble without wheels is refused on the command line as in a problem") {
  const Workshop shop;
  const Outcome run =
      shop.run("simulate '" + source_path("problems/planar_two_link_post_impact_a.yaml") +
               "' --controller detumble");
  INFO(run.err);
  CHECK(run.code == 2);
  CHECK(
      run.says("--controller detumble: takes the momentum with wheels, and the problem has none"));
}

TEST_CASE("an unknown subcommand is named beside the known ones") {
  const Workshop shop;
  require_wrong_command_line(shop, "frobnicate plan.json", "no subcommand 'frobnicate'");
  CHECK(shop.run("frobnicate").says("check, inspect, analyze, plan"));
}

TEST_CASE("the number of starts has one bound in files and on the command line") {
  const Workshop shop;
  shop.write_changed("problem.yaml", kProblem, "purpose:", "search: {starts: 10000001}\npurpose:");
  const Outcome in_file = shop.run("check problem.yaml");
  INFO(in_file.err);
  CHECK(in_file.code == 3);
  CHECK(in_file.says("10000000"));
  shop.write("problem.yaml", file_text(source_path(kProblem)));
  require_wrong_command_line(shop, "plan problem.yaml -o plan.json --starts 10000001", "10000000");
}

TEST_CASE("help that cannot be written is a failure to write") {
  const Workshop shop;
  CHECK(shop.run_script("'" STILLBASE_TOOL "' --help > /dev/full").code == 7);
  CHECK(shop.run_script("'" STILLBASE_TOOL "' plan --help > /dev/full").code == 7);
  CHECK(shop.run_script("'" STILLBASE_TOOL "' --version > /dev/full").code == 7);
  CHECK(shop.run("plan --help").out.find("--time-limit") != std::string::npos);
}

TEST_CASE("states whose matrices do not fit a double are refused") {
  const Workshop shop;
  const auto refused = [&](const std::string& state) {
    shop.write("state.json", state);
    const Outcome outcome =
        shop.run("inspect robots/planar_two_link_a.urdf --state state.json --json");
    INFO(state << "\n" << outcome.err);
    CHECK(outcome.code == 3);
    CHECK(outcome.says("state.json:"));
    CHECK(outcome.out.empty());
  };
  refused(R"({"joint_velocities": [1e308, 1e308]})");
  refused(R"({"joint_positions": [1e308, 0]})");
  refused(R"({"base_velocity": {"linear": [1e308, 0, 0]}})");
  refused(R"({"base_velocity": {"angular": [0, -1e308, 0]}})");
  refused(R"({"impulse": {"force": [1e308, 1e308, 0], "moment": [0, 0, 0]}})");
  shop.write("state.json", R"({"joint_velocities": [1e3, -1e3]})");
  CHECK(shop.run("inspect robots/planar_two_link_a.urdf --state state.json --json").code == 0);
}

TEST_CASE("an empty file is one finding, not what follows from it") {
  const Workshop shop;
  for (const char* text : {"", "# nothing but a comment\n", "~\n", "[]\n", "word\n"}) {
    shop.write("problem.yaml", text);
    for (const char* command : {"check problem.yaml", "plan problem.yaml -o plan.json"}) {
      const Outcome outcome = shop.run(command);
      INFO(text << command << "\n" << outcome.err);
      CHECK(outcome.code == 3);
      CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    }
  }
}

TEST_CASE("a verification that a signal ends gives no verdict") {
  const Workshop shop;
  const std::string plan = "plan '" + source_path(kProblem) + "' -o plan.json";
  REQUIRE(shop.run(plan).code == 0);
  // An hour of simulated time, so that the signal comes before the end.
  json changed = json::parse(shop.text("plan.json"));
  changed["problem"]["post_impact"] = {{"controllers", {"rns_damped", "none"}},
                                       {"control_period", 0.0001},
                                       {"horizon", 3600},
                                       {"residual_base_rate_max", 1},
                                       {"attitude_change_max", 1}};
  shop.write("long.json", changed.dump());
  const Outcome outcome = shop.run_script("'" STILLBASE_TOOL
                                          "' verify long.json -o verdict.json & p=$!; sleep 2; "
                                          "kill -TERM $p; wait $p");
  INFO(outcome.err);
  CHECK(outcome.code == 143);
  CHECK(outcome.says("interrupted"));
  CHECK_FALSE(outcome.says("FAIL,"));
  REQUIRE(shop.has("verdict.json"));
  const json verdict = json::parse(shop.text("verdict.json"));
  CHECK(verdict.at("verdict") == "fail");
  CHECK(verdict.at("interrupted") == true);
  for (const json& claim : verdict.at("claims")) {
    INFO(claim.at("name"));
    if (claim.at("value").is_null()) CHECK(claim.at("pass").is_null());
  }
}
