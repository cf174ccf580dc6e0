// verify --trials, simulate --plot and campaign from the shell.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::ordered_json;

namespace {

const char* const kSpec =
    "format: stillbase.campaign\nversion: 1\nplans: [plan.json]\nseeds: [1, 2]\n"
    "trials: 12\ntrials_per_case: 4\n";

void make_plan_and_cases(const Workshop& shop) {
  const std::string problem = source_path("problems/planar_two_link_c2_a.yaml");
  REQUIRE(shop.run("plan '" + problem + "' -o plan.json").code == 0);
  shop.write("spec.yaml", kSpec);
  REQUIRE(shop.run("campaign make spec.yaml -o cases.jsonl").code == 0);
}

}  // namespace

TEST_CASE("a campaign's trials are those of verify, for any number of shards and workers") {
  const Workshop shop;
  make_plan_and_cases(shop);
  const std::string cases = shop.text("cases.jsonl");
  CHECK(std::count(cases.begin(), cases.end(), '\n') == 6);

  CHECK(shop.run("campaign run cases.jsonl --jobs 2 -o A").code == 0);
  CHECK(shop.run("campaign merge A -o a.json").code == 0);
  CHECK(shop.run("campaign run cases.jsonl --shard 2/2 -o B").code == 0);
  CHECK(shop.run("campaign merge B -o part.json").code == 8);
  CHECK(ordered_json::parse(shop.text("part.json")).at("missing").size() == 3);
  CHECK(shop.run("campaign run cases.jsonl --shard 1/2 -o B").code == 0);
  CHECK(shop.run("campaign merge B -o b.json").code == 0);
  CHECK(shop.text("a.json") == shop.text("b.json"));

  const ordered_json merged = ordered_json::parse(shop.text("a.json"));
  CHECK(merged.at("complete") == true);
  REQUIRE(merged.at("groups").size() == 2);
  const Outcome verified = shop.run("verify plan.json --trials 12 --seed 2 --jobs 2");
  CHECK(verified.code == 0);
  CHECK(verified.says(" worst      limit "));
  const ordered_json trials = ordered_json::parse(verified.out).at("trials");
  CHECK(trials == merged.at("groups").at(1).at("trials"));
  CHECK(trials.at("count") == 12);
  CHECK(trials.at("success_interval").at("method") == "wilson");
  CHECK(trials != merged.at("groups").at(0).at("trials"));
}

TEST_CASE("a file that changed after make, or is not there, is no record of its cases") {
  const Workshop shop;
  make_plan_and_cases(shop);
  const std::string plan = shop.text("plan.json");
  shop.write("plan.json", plan + "\n");
  const Outcome changed = shop.run("campaign run cases.jsonl -o A");
  CHECK(changed.code == 3);
  CHECK(changed.says("plan.json: fingerprint: the file has changed"));
  std::filesystem::remove(shop.path("plan.json"));
  const Outcome missing = shop.run("campaign run cases.jsonl -o A");
  CHECK(missing.code == 3);
  CHECK(missing.says("plan.json: missing-file"));
  CHECK(shop.run("campaign merge A -o a.json").code == 8);
  CHECK(ordered_json::parse(shop.text("a.json")).at("records").empty());

  shop.write("plan.json", plan);
  CHECK(shop.run("campaign run cases.jsonl -o A").code == 0);
  CHECK(shop.run("campaign merge A -o b.json").code == 0);
}

TEST_CASE("a robot file that is not there is no record of a problem's case") {
  const Workshop shop;
  shop.write("problem.yaml", file_text(source_path("problems/planar_two_link_c2_a.yaml")));
  shop.write("spec.yaml",
             "format: stillbase.campaign\nversion: 1\nproblems: [problem.yaml]\ntrials: 2\n");
  REQUIRE(shop.run("campaign make spec.yaml -o cases.jsonl").code == 0);
  std::filesystem::rename(shop.path("robots"), shop.path("away"));
  const Outcome missing = shop.run("campaign run cases.jsonl -o A");
  CHECK(missing.code == 3);
  CHECK(missing.says("missing-file"));
  std::filesystem::rename(shop.path("away"), shop.path("robots"));
  CHECK(shop.run("campaign run cases.jsonl -o A").code == 0);
  CHECK(shop.run("campaign merge A -o a.json").code == 0);
}

TEST_CASE("campaign refuses what makes no sense") {
  const Workshop shop;
  shop.write("spec.yaml", "format: stillbase.campaign\nversion: 1\ntrails: 3\n");
  const Outcome outcome = shop.run("campaign make spec.yaml");
  CHECK(outcome.code == 3);
  CHECK(outcome.says("spec.yaml:3: unknown-key"));
  CHECK(shop.run("campaign run nothing.jsonl -o A").code == 3);
  shop.write("cases.jsonl", "{}\n");
  CHECK(shop.run("campaign run cases.jsonl --shard 3/2 -o A").code == 2);
  CHECK(shop.run("campaign merge nowhere").code == 3);
  CHECK(shop.run("campaign").code == 2);
}

TEST_CASE("the shipped script runs a campaign under GNU parallel") {
  if (std::system("command -v parallel >/dev/null 2>&1") != 0) {
    WARN("skipped: GNU parallel is not installed");
    return;
  }
  const Workshop shop;
  make_plan_and_cases(shop);
  const std::string script = source_path("tools/campaign/parallel.sh");
  const Outcome outcome =
      shop.run_script("PATH=\"$(dirname '" STILLBASE_TOOL "'):$PATH\" sh '" + script +
                      "' cases.jsonl A 3 && '" STILLBASE_TOOL "' campaign merge A -o a.json");
  INFO(outcome.err);
  CHECK(outcome.code == 0);
  CHECK(ordered_json::parse(shop.text("a.json")).at("complete") == true);
}

TEST_CASE("the shipped script runs a campaign as a Slurm array") {
  // A cluster of this machine alone; 77: it cannot be started here.
  const Workshop shop;
  make_plan_and_cases(shop);
  const Outcome outcome = shop.run_script(
      "mkdir cluster && PATH=\"$(dirname '" STILLBASE_TOOL "'):$PATH\" '" +
      source_path("tests/cli/one_node_slurm.sh") + "' cluster sbatch --wait --array=1-3 '" +
      source_path("tools/campaign/slurm.sh") + "' cases.jsonl A");
  INFO(outcome.out << outcome.err);
  if (outcome.code == 77) {
    WARN("skipped: no Slurm can be started here: " << outcome.err);
    return;
  }
  CHECK(outcome.code == 0);
  CHECK(shop.run("campaign merge A -o a.json").code == 0);
  CHECK(ordered_json::parse(shop.text("a.json")).at("complete") == true);
}

TEST_CASE("simulate draws the paper's figures for every controller") {
  const Workshop shop;
  const std::string problem = source_path("problems/planar_two_link_post_impact_b.yaml");
  CHECK(shop.run("simulate '" + problem + "' --plot out.svg --trace out.csv").code == 0);
  const std::string svg = shop.text("out.svg");
  for (const char* title : {"rns_damped: (a) base attitude", "rns: (b) angular momenta",
                            "joint_damping: (c) joint rate"}) {
    CHECK(svg.find(title) != std::string::npos);
  }
  CHECK(shop.text("out.csv").rfind("time_s,", 0) == 0);
  CHECK(shop.run("simulate '" + problem + "' --plot out.svg").code == 7);
}
