// How runs end: signals, limits, workers that are killed, streams that take nothing.
#include <catch2/catch.hpp>

#include <algorithm>
#include <regex>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::ordered_json;

namespace {

const std::string kPlanar = "'" + source_path("problems/planar_two_link_c2_a.yaml") + "'";
const std::string kTool = "'" STILLBASE_TOOL "' ";

/// Runs the tool and kills its workers with SIGKILL, about 40 times a second, for a while. Under
/// AddressSanitizer the search for leaks is a child, too, for which the tool would wait forever.
Outcome run_among_killers(const Workshop& shop, const std::string& arguments) {
  return shop.run_script("ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 " + kTool + arguments +
                         " &\n"
                         "pid=$!\n"
                         "for i in $(seq 60); do\n"
                         "  for worker in $(cat /proc/$pid/task/$pid/children 2>/dev/null); do\n"
                         "    kill -9 $worker 2>/dev/null\n"
                         "  done\n"
                         "  sleep 0.02\n"
                         "done\n"
                         "wait $pid\n");
}

void make_cases(const Workshop& shop) {
  REQUIRE(shop.run("plan " + kPlanar + " -o plan.json").code == 0);
  shop.write("spec.yaml",
             "format: stillbase.campaign\nversion: 1\nplans: [plan.json]\nseeds: [1]\n"
             "trials: 24\ntrials_per_case: 4\n");
  REQUIRE(shop.run("campaign make spec.yaml -o cases.jsonl").code == 0);
}

ordered_json plan_of(const Workshop& shop, const std::string& name) {
  ordered_json plan = ordered_json::parse(shop.text(name));
  plan.erase("timing");
  return plan;
}

}  // namespace

TEST_CASE("killed workers leave no case of a campaign without its result") {
  const Workshop shop;
  make_cases(shop);
  const Outcome killed = run_among_killers(shop, "campaign run cases.jsonl -o A");
  INFO(killed.err);
  CHECK((killed.code == 0 || killed.code == 8));
  const Outcome merged = shop.run("campaign merge A -o a.json");
  CHECK(merged.code == killed.code);
  if (killed.code == 8) CHECK(merged.says("workers died"));
  CHECK(shop.run("campaign run cases.jsonl -o A").code == 0);
  CHECK(shop.run("campaign merge A -o b.json").code == 0);
  CHECK(shop.run("campaign run cases.jsonl -o B").code == 0);
  CHECK(shop.run("campaign merge B -o c.json").code == 0);
  CHECK(shop.text("b.json") == shop.text("c.json"));
  CHECK(ordered_json::parse(shop.text("b.json")).at("groups").at(0).at("trials").at("count") == 24);
}

TEST_CASE("killed workers leave no run of a benchmark without its record") {
  const Workshop shop;
  const std::string bench = "bench --suite '" + source_path("bench/suite.yaml") +
                            "' --optimizers nlopt-slsqp,ipopt --seeds 3 --budget 200 --jobs 2 "
                            "-o A " +
                            kPlanar;
  const Outcome killed = run_among_killers(shop, bench);
  INFO(killed.err);
  CHECK((killed.code == 0 || killed.code == 8));
  if (killed.code == 8) CHECK(killed.says("its worker died"));
  const Outcome resumed = shop.run(bench);
  INFO(resumed.err);
  CHECK(resumed.code == 0);
  const std::string records = shop.text("A/records.jsonl");
  CHECK(std::count(records.begin(), records.end(), '\n') % 6 == 0);
  CHECK(records.find("\"crashed\"") == std::string::npos);
  CHECK(records.find("\"died\"") == std::string::npos);
}

TEST_CASE("a list of cases that is none is refused with its lines by run as by merge") {
  const Workshop shop;
  make_cases(shop);
  shop.write("junk.jsonl", shop.text("cases.jsonl") + "junk\n{\"plan\": 1}\n");
  const Outcome run = shop.run("campaign run junk.jsonl -o A");
  CHECK(run.code == 3);
  CHECK(run.says("junk.jsonl:7: "));
  CHECK(run.says("junk.jsonl:8: "));
  CHECK_FALSE(shop.has("A"));
  REQUIRE(shop.run_script("mkdir B && cp junk.jsonl B/cases.jsonl").code == 0);
  const Outcome merge = shop.run("campaign merge B");
  CHECK(merge.code == 3);
  CHECK(merge.says("cases.jsonl:7: "));
  shop.write("twice.jsonl", shop.text("cases.jsonl") + shop.text("cases.jsonl"));
  CHECK(shop.run("campaign run twice.jsonl -o C").says("twice.jsonl:7: duplicate-case"));
}

TEST_CASE("a trial that two cases of a list have is refused by run as by merge") {
  const Workshop shop;
  make_cases(shop);
  const ordered_json first =
      ordered_json::parse(shop.text("cases.jsonl").substr(0, shop.text("cases.jsonl").find('\n')));
  const auto list_of = [&](const std::vector<std::pair<int, int>>& ranges) {
    std::string text;
    for (const auto& [begin, count] : ranges) {
      ordered_json piece = first;
      piece["first"] = begin;
      piece["count"] = count;
      text += piece.dump() + "\n";
    }
    return text;
  };
  // The second list names the later trials first, and the third has one case inside another.
  const std::vector<std::vector<std::pair<int, int>>> lists = {
      {{1, 3}, {3, 3}}, {{3, 3}, {1, 3}}, {{0, 9}, {4, 1}}, {{4, 1}, {0, 9}}, {{0, 2}, {0, 1}}};
  for (const auto& ranges : lists) {
    shop.write("overlap.jsonl", list_of(ranges));
    const Outcome run = shop.run("campaign run overlap.jsonl -o A");
    INFO(run.err);
    CHECK(run.code == 3);
    CHECK(run.says("overlap.jsonl:2: overlapping-case: "));
    CHECK(run.says("plan.json, seed 1: line 1 has "));
    CHECK_FALSE(shop.has("A"));
    REQUIRE(shop.run_script("rm -rf B && mkdir B && cp overlap.jsonl B/cases.jsonl").code == 0);
    const Outcome merge = shop.run("campaign merge B");
    CHECK(merge.code == 3);
    CHECK(merge.says("cases.jsonl:2: overlapping-case: "));
  }
  shop.write("overlap.jsonl", list_of({{1, 3}, {3, 3}}));
  CHECK(shop.run("campaign run overlap.jsonl -o A").says("trials 3 to 5 of "));
  CHECK(shop.run("campaign run overlap.jsonl -o A").says("line 1 has trials 1 to 3 of it"));

  // Another seed has trials of its own, and a case without trials shares none.
  ordered_json other = first;
  other["seed"] = 2;
  shop.write("gaps.jsonl", list_of({{9, 2}, {3, 3}, {4, 0}}) + other.dump() + "\n");
  CHECK(shop.run("campaign run gaps.jsonl -o C").code == 0);
  const Outcome merged = shop.run("campaign merge C -o c.json");
  CHECK(merged.code == 0);
  CHECK(merged.says("trials 0 to 2, trials 6 to 8 of "));
  CHECK(merged.says("plan.json, seed 1 are in no case"));
  CHECK_FALSE(merged.says("seed 2 are in no case"));
  const ordered_json trials =
      ordered_json::parse(shop.text("c.json")).at("groups").at(0).at("trials");
  CHECK(trials.at("count") == 5);
  for (const ordered_json& spread : trials.at("distributions")) {
    const int worst = spread.at("worst_trial");
    CHECK(((worst >= 3 && worst <= 5) || worst == 9 || worst == 10));
  }
}

TEST_CASE("messages that nobody takes do not end a run") {
  const Workshop shop;
  REQUIRE(shop.run("plan " + kPlanar + " -o plan.json").code == 0);
  const ordered_json expected = plan_of(shop, "plan.json");
  int number = 0;
  for (const char* how : {"2>&-", "2>/dev/full", ">&- 2>&-", "<&- 2>&-"}) {
    const std::string name = "plan" + std::to_string(number++) + ".json";
    INFO(how);
    CHECK(shop.run_script(kTool + "plan " + kPlanar + " -o " + name + " " + how).code == 0);
    CHECK(plan_of(shop, name) == expected);
  }
  // A pipe whose reader has left.
  CHECK(shop.run_script("(" + kTool + "plan " + kPlanar +
                        " -o piped.json; echo $? >code) 2>&1 | true\nexit $(cat code)")
            .code == 0);
  CHECK(plan_of(shop, "piped.json") == expected);
}

TEST_CASE("results that nobody takes are a failed write") {
  const Workshop shop;
  for (const char* how : {">&-", ">/dev/full"}) {
    CHECK(shop.run_script(kTool + "plan " + kPlanar + " " + how).code == 7);
  }
  // Below what is no folder nobody can make one, not even a library that is run by root.
  CHECK(shop.run_script("TMPDIR=/dev/null/nowhere " + kTool + "bench --quick --suite '" +
                        source_path("bench/suite.yaml") + "' --optimizers ipopt " + kPlanar)
            .code == 7);
}

TEST_CASE("a time limit before the approach leaves it stopped, with exit code 6") {
  const Workshop shop;
  const std::string problem = "'" + source_path("problems/iiwa_reaction_null.yaml") + "'";
  for (const char* limit : {"0.01", "0.03", "0.06", "0.12", "0.2", "0.3"}) {
    INFO(limit);
    const Outcome outcome =
        shop.run("plan " + problem + " --force -o plan.json --time-limit " + std::string(limit));
    const ordered_json plan = ordered_json::parse(shop.text("plan.json"));
    const std::string approach = plan.at("approach").at("status");
    INFO(outcome.err);
    CHECK((outcome.code == 6 || (outcome.code == 0 && approach == "found")));
    CHECK(approach != "not_requested");
    CHECK((plan.at("status") == "limit") == (outcome.code == 6));
    if (limit == std::string("0.01")) CHECK(approach == "stopped");
  }
}

TEST_CASE("a time limit before the time after the impact is judged is exit code 6") {
  const Workshop shop;
  // The search takes a tenth of a second, an hour after the impact under rns_damped ten.
  shop.write_changed("long.yaml", "problems/planar_two_link_c2_a.yaml", "horizon: 10 s",
                     "horizon: 3600 s");
  shop.write("long.yaml", std::regex_replace(shop.text("long.yaml"), std::regex("\napproach:"),
                                             "\napproach:\n  enabled: false"));
  for (const char* limit : {"0.3", "1"}) {
    const Outcome outcome =
        shop.run("plan long.yaml --force -o plan.json --time-limit " + std::string(limit));
    INFO(limit << ": " << outcome.err);
    CHECK(outcome.code == 6);
    CHECK(ordered_json::parse(shop.text("plan.json")).at("status") == "limit");
  }
}

TEST_CASE("a signal to a process and its group saves what was found, as one signal does") {
  const Workshop shop;
  const std::string problem = "'" + source_path("problems/deos_client_224.yaml") + "'";
  for (const auto& [name, code] : {std::pair("INT", 130), std::pair("TERM", 143)}) {
    INFO(name);
    // As `timeout` and batch systems do: to the process, then to its group.
    const std::string send = "kill -" + std::string(name) + " $pid\n";
    const Outcome outcome = shop.run_script(
        kTool + "plan " + problem + " --force --starts 5000 -o plan.json &\npid=$!\n" +
        "sleep 0.7\n" + send + "sleep 0.02\n" + send + "wait $pid");
    CHECK(outcome.code == code);
    REQUIRE(shop.has("plan.json"));
    const ordered_json plan = ordered_json::parse(shop.text("plan.json"));
    CHECK(plan.at("status") == "limit");
    CHECK(plan.at("approach").at("status") != "not_requested");
  }
}

TEST_CASE("a file that may not grow to its size is a failed write") {
  const Workshop shop;
  const std::string limited = "ulimit -f 1; ";
  if (shop.run_script(limited + kTool + "--version").code != 0) {
    WARN("a library of Ipopt's writes larger files before the tool begins");
    return;
  }
  const Outcome outcome = shop.run_script(limited + kTool + "plan " + kPlanar + " -o plan.json");
  CHECK(outcome.code == 7);
  CHECK_FALSE(shop.has("plan.json"));
}
