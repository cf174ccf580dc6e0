// What the tool says on a terminal: short verdicts, progress, suggestions.
#include <catch2/catch.hpp>

#include <algorithm>
#include <regex>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::ordered_json;

namespace {

const std::string kClient = "'" + source_path("problems/planar_three_link_client.yaml") + "'";
constexpr const char* kToolCommand = "'" STILLBASE_TOOL "' ";

long lines_of(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

/// Output of a command whose stdout and stderr are a terminal.
std::string on_terminal(const Workshop& shop, const std::string& command,
                        const std::string& environment = "TERM=xterm") {
  const Outcome outcome = shop.run_script("env " + environment + " script -qec \"" + command +
                                          "\" /dev/null </dev/null");
  return outcome.out + outcome.err;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("verify prints the verdict first and one line per group, all checks with --all") {
  const Workshop shop;
  REQUIRE(shop.run("plan " + kClient + " -o plan.json").code == 0);
  const Outcome good = shop.run("verify plan.json -o verification.json");
  INFO(good.err);
  CHECK(good.err.rfind("verdict: pass, all ", 0) == 0);
  CHECK(lines_of(good.err) <= 40);
  CHECK_FALSE(good.says("impulse_force"));
  CHECK(good.says(" hold  physics: "));
  CHECK(good.says("\nnext: stillbase report plan.json verification.json -o plan.html\n"));
  CHECK(shop.run("verify plan.json").says("\nnext: stillbase report plan.json -o plan.html\n"));
  const Outcome all = shop.run("verify plan.json --all -o all.json");
  CHECK(all.says("impulse_force"));
  CHECK(lines_of(all.err) > 90);
  CHECK(shop.text("all.json") == shop.text("verification.json"));
  CHECK(lines_of(shop.run("audit plan.json -o audit.json").err) <= 40);

  ordered_json plan = ordered_json::parse(shop.text("plan.json"));
  plan.at("impact").at("impulse").at("force").at(0) = 1.0;
  shop.write("changed.json", plan.dump());
  const Outcome bad = shop.run("verify changed.json -o bad.json");
  CHECK(bad.code == 5);
  CHECK(bad.err.rfind("verdict: FAIL, ", 0) == 0);
  CHECK(bad.says("FAILED impulse_force "));
  CHECK_FALSE(bad.says("ok     "));
  CHECK(std::regex_search(bad.err, std::regex("[0-9]+ of [0-9]+ hold  physics: ")));
  CHECK(bad.says("\nnext: stillbase verify changed.json --all\n"));
}

TEST_CASE("a plan's summary fits a screen and ends with the next command") {
  const Workshop shop;
  const Outcome outcome = shop.run("plan " + kClient + " -o 'my plan.json'");
  INFO(outcome.err);
  CHECK(lines_of(outcome.err) <= 24);
  CHECK(outcome.says("next: stillbase verify 'my plan.json' -o 'my plan.verification.json'\n"));
  CHECK(shop.run("verify 'my plan.json' -o 'my plan.verification.json'").code == 0);
  const Outcome check = shop.run("check " + kClient);
  CHECK(check.says("next: stillbase plan "));
}

TEST_CASE("misspelt commands, options and words are refused with the nearest one") {
  const Workshop shop;
  const auto suggests = [&shop](const std::string& arguments, const std::string& word) {
    const Outcome outcome = shop.run(arguments);
    INFO(arguments << "\n" << outcome.err);
    CHECK(outcome.code == 2);
    CHECK(outcome.says("did you mean '" + word + "'?"));
  };
  suggests("plann problem.yaml", "plan");
  suggests("campaign mrege folder", "merge");
  suggests("plan problem.yaml --sed 3", "--seed");
  suggests("verify plan.json --trails=3", "--trials");
  suggests("campaign run cases.jsonl --shards 1/2", "--shard");
  suggests("plan " + kClient + " --optimizer ipop", "ipopt");
  suggests("simulate " + kClient + " --controller rns_dampd", "rns_damped");
  suggests("schema problm", "problem");
  shop.write_changed("problem.yaml", "problems/planar_three_link_client.yaml",
                     "uncertainty:", "uncertainity:");
  const Outcome key = shop.run("check problem.yaml");
  CHECK(key.code == 3);
  CHECK(key.says("did you mean 'uncertainty'?"));
}

TEST_CASE("an ending that a command cannot write is refused before the work") {
  const Workshop shop;
  REQUIRE(shop.run("plan " + kClient + " -o plan.json").code == 0);
  const std::pair<std::string, std::string> wrong[] = {
      {"plan " + kClient + " -o plan.yaml", ".json"},
      {"verify plan.json -o verdict.txt", ".json"},
      {"audit plan.json -o verdict.html", ".json"},
      {"report plan.json -o report.pdf", ".html, .htm"},
      {"simulate plan.json --trace trace.svg", ".csv"},
      {"simulate plan.json --plot plot.png", ".svg"},
      {"schema plan -o schema.yaml", ".json"},
      {"inspect robots/deos.urdf --hand hand -o out.csv", ".json, .txt"},
      {"plan " + kClient + " -o plan", ".json"}};
  for (const auto& [arguments, endings] : wrong) {
    const Outcome outcome = shop.run(arguments);
    INFO(arguments << "\n" << outcome.err);
    CHECK(outcome.code == 2);
    CHECK(outcome.says("this command writes " + endings));
  }
}

TEST_CASE("progress with the time left is for terminals, pipes stay quiet") {
  const Workshop shop;
  REQUIRE(shop.run("plan " + kClient + " -o plan.json").code == 0);
  const std::string trials = std::string(kToolCommand) + "verify plan.json --trials 400 -o ";
  const std::string shown = on_terminal(shop, trials + "a.json");
  INFO(shown);
  CHECK(std::regex_search(shown, std::regex("trials [0-9]+/400, [0-9]+ s left")));
  const Outcome quiet = shop.run("verify plan.json --trials 400 -o b.json");
  CHECK_FALSE(quiet.says("/400"));
  CHECK_FALSE(quiet.says("\r"));
  CHECK(
      has(on_terminal(shop, std::string(kToolCommand) + "plan " + kClient + " -o c.json"), "/64"));
}

TEST_CASE("colours are for terminals that allow them") {
  const Workshop shop;
  REQUIRE(shop.run("plan " + kClient + " -o plan.json").code == 0);
  const std::string command = std::string(kToolCommand) + "verify plan.json -o v.json --force";
  const std::string green = "\033[32mverdict: pass";
  CHECK(has(on_terminal(shop, command, "-u NO_COLOR TERM=xterm"), green));
  CHECK_FALSE(has(on_terminal(shop, command, "TERM=xterm NO_COLOR=1"), "\033[3"));
  CHECK_FALSE(has(on_terminal(shop, command, "-u NO_COLOR TERM=dumb"), "\033[3"));
  CHECK_FALSE(shop.run("verify plan.json -o v.json --force").says("\033["));
}

TEST_CASE("campaign merge prints probability, percentiles with units, worst case and its driver") {
  const Workshop shop;
  REQUIRE(shop.run("plan " + kClient + " -o plan.json").code == 0);
  shop.write("campaign.yaml",
             "format: stillbase.campaign\nversion: 1\nplans: [plan.json]\nseeds: [1, 2]\n"
             "trials: 60\ntrials_per_case: 20\n");
  const Outcome make = shop.run("campaign make campaign.yaml -o cases.jsonl");
  CHECK(make.says("6 cases\nnext: stillbase campaign run cases.jsonl -o cases\n"));
  const Outcome part = shop.run("campaign run cases.jsonl -o cases --shard 1/2");
  CHECK(part.says("next: stillbase campaign merge cases -o cases.json\n"));
  const Outcome early = shop.run("campaign merge cases -o early.json");
  CHECK(early.code == 8);
  CHECK(early.says("next: stillbase campaign run cases/cases.jsonl -o cases\n"));
  REQUIRE(shop.run("campaign run cases.jsonl -o cases").code == 0);
  const Outcome merged = shop.run("campaign merge cases -o cases.json");
  INFO(merged.err);
  CHECK(merged.code == 0);
  CHECK(lines_of(merged.err) <= 24);
  CHECK(merged.says("plan.json, seed 1: 60 trials: "));
  CHECK(merged.says("plan.json, seed 2: 60 trials: "));
  CHECK(std::regex_search(
      merged.err,
      std::regex("probability [01]\\.[0-9]+ \\(95 % interval [0-9.]+ to [0-9.]+, Wilson")));
  CHECK(std::regex_search(
      merged.err,
      std::regex(
          "\n  objective +[0-9.e-]+ +[0-9.e-]+ +[0-9.e-]+ +[0-9.e-]+ N m s +[0-9]+  [a-z_ ]+")));
  CHECK(merged.says("driven by (rank correlation)"));
  CHECK(merged.says("next: stillbase report cases.json -o cases.html\n"));
  const ordered_json result = ordered_json::parse(shop.text("cases.json"));
  CHECK(result.dump().find("as the plan") == std::string::npos);
}
