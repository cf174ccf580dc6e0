// bench and report from the shell.
#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <regex>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::ordered_json;

namespace {

std::string bench(const std::string& arguments) {
  return "bench --suite '" + source_path("bench/suite.yaml") + "' " + arguments;
}

/// Records without what is measured.
std::string unmeasured(const std::string& lines) {
  std::string out;
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);) {
    ordered_json record = ordered_json::parse(line);
    CHECK(record.at("measured").contains("host"));
    record.erase("measured");
    out += record.dump() + "\n";
  }
  return out;
}

const char* const kSmall =
    "--select planar_two_link/case/0,spart/nominal/1 --seeds 2 --budget 150 "
    "--optimizers nlopt-slsqp,ipopt,nlopt-isres,random-search,nlopt-slsqp:defaults ";

const char* const kFiles[] = {"bench.json", "runs.csv",         "report.md",
                              "ecdf.svg",   "data_profile.svg", "performance_profile.svg"};

}  // namespace

TEST_CASE("bench leaves foreign files alone and says what it was asked wrongly") {
  const Workshop shop;
  std::filesystem::create_directory(shop.path("own"));
  shop.write("own/report.md", "mine");
  const std::string small = "--optimizers nlopt-slsqp --seeds 1 --budget 50 ";
  const Outcome foreign = shop.run(bench(small + "--select spart/nominal/1 -o own"));
  CHECK(foreign.code == 7);
  CHECK(foreign.err.find("holds files, but no runs of a benchmark") != std::string::npos);
  CHECK(shop.text("own/report.md") == "mine");
  const std::string problem = "'" + source_path("problems/planar_two_link_c2_a.yaml") + "' ";
  for (const std::string& wrong :
       {problem + "--update-best-known", std::string("--select spart/nominal/1,nowhere"),
        std::string("--optimizers nlopt-slsqp,nlopt-slsqp")}) {
    CAPTURE(wrong);
    CHECK(shop.run(bench(wrong)).code == 2);
  }
}

TEST_CASE("the quick benchmark runs every optimizer on every kind of problem") {
  const Workshop shop;
  const Outcome outcome = shop.run(bench("--quick -o Q"));
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const std::string report = shop.text("Q/report.md");
  for (const char* section :
       {"## Solved runs", "## Which one by default", "## Where each wins", "## Success by family",
        "## Expected running time to 1e-08", "## Profiles", "## Unsolved problems"}) {
    CAPTURE(section);
    CHECK(report.find(section) != std::string::npos);
  }
  CHECK(report.find("Gould and Scott") != std::string::npos);
  const Outcome list = shop.run("bench --list");
  CHECK(list.code == 0);
  CHECK(std::count(list.out.begin(), list.out.end(), '\n') >= 14 + 2);
  std::istringstream names(list.out);
  std::string line;
  std::getline(names, line);
  std::getline(names, line);
  while (std::getline(names, line)) {
    const std::string name = line.substr(2, line.find(' ', 2) - 2);
    CAPTURE(name);
    CHECK(report.find("| " + name + " ") != std::string::npos);
  }
  const std::string records = shop.text("Q/records.jsonl");
  const auto count = std::count(records.begin(), records.end(), '\n');
  CHECK(count >= 14 * 14 * 2);
  for (const std::string key : {"\"options\":", "\"library\":", "\"limits\":", "\"stop_reason\":",
                                "\"stillbase\":", "\"host\":", "\"seed\":", "\"improvements\":"}) {
    std::ptrdiff_t found = 0;
    for (std::size_t at = records.find(key); at != std::string::npos;
         at = records.find(key, at + 1)) {
      ++found;
    }
    CAPTURE(key);
    CHECK(found >= count);
  }
}

TEST_CASE("results do not depend on the number of workers, but for what is measured") {
  const Workshop shop;
  REQUIRE(shop.run(bench(kSmall) + "--jobs 1 -o A").code == 0);
  REQUIRE(shop.run(bench(kSmall) + "--jobs 3 -o B").code == 0);
  CHECK(unmeasured(shop.text("A/records.jsonl")) == unmeasured(shop.text("B/records.jsonl")));
  for (const char* file : kFiles) {
    CAPTURE(file);
    CHECK(shop.text(std::string("A/") + file) == shop.text(std::string("B/") + file));
  }
  CHECK(shop.text("A/report.md").find("library's defaults") != std::string::npos);
}

TEST_CASE("a benchmark with every problem solved does not count the unsolved ones") {
  const Workshop shop;
  REQUIRE(shop.run(bench("--select planar_two_link/case/0 --seeds 1 --budget 500 "
                         "--optimizers nlopt-slsqp,nlopt-isres -o A"))
              .code == 0);
  const std::string report = shop.text("A/report.md");
  CHECK(report.find("None: every problem was solved") != std::string::npos);
  CHECK(report.find("No optimizer solved") == std::string::npos);
}

TEST_CASE("a benchmark that was killed goes on where it was") {
  const Workshop shop;
  REQUIRE(shop.run(bench(kSmall) + "-o A").code == 0);
  std::filesystem::create_directories(shop.path("B/runs"));
  shop.write("B/runs/cases.jsonl", shop.text("A/runs/cases.jsonl"));
  const std::string journal = shop.text("A/runs/journal-1-of-1.txt");
  // Half of the journal, the last record torn.
  shop.write("B/runs/journal-1-of-1.txt", journal.substr(0, journal.size() / 2));
  REQUIRE(shop.run(bench(kSmall) + "-o B").code == 0);
  CHECK(unmeasured(shop.text("A/records.jsonl")) == unmeasured(shop.text("B/records.jsonl")));
  const std::string again = shop.text("B/runs/journal-1-of-1.txt");
  CHECK(std::count(again.begin(), again.end(), '\n') ==
        std::count(journal.begin(), journal.end(), '\n'));
  // What it had is kept byte for byte, times included.
  const std::string kept = journal.substr(0, journal.rfind('\n', journal.size() / 2) + 1);
  CHECK(again.rfind(kept, 0) == 0);
  // Another benchmark may not go on in this folder.
  CHECK(shop.run(bench("--select spart/nominal/1 --seeds 1 --budget 150 -o B")).code == 3);
}

TEST_CASE("Ctrl-C ends a benchmark without loss") {
  const Workshop shop;
  const Outcome outcome = shop.run_script(
      "'" STILLBASE_TOOL "' " + bench("--instances 2 --seeds 5 --budget 2000 --jobs 1 -o A") +
      " & pid=$!; while ! grep -q finished A/runs/journal-1-of-1.txt 2>/dev/null; do sleep 0.1; "
      "done; kill -TERM $pid; wait $pid");
  CHECK(outcome.code == 143);
  CHECK(outcome.says("the same command goes on from there"));
  CHECK(shop.text("A/runs/journal-1-of-1.txt").find(" finished ") != std::string::npos);
  CHECK_FALSE(shop.has("A/report.md"));
}

TEST_CASE("a solver that hangs without asking for evaluations is a record") {
  const Workshop shop;
  // CCSAQ's dual problem with the library's own options takes seconds per evaluation here.
  const Outcome outcome = shop.run(
      bench("--select planar_two_link/worst_case/0 --seeds 1 --budget 100000 --run-limit 0.2 "
            "--optimizers nlopt-ccsaq:defaults,nlopt-slsqp -o A"));
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const std::string records = shop.text("A/records.jsonl");
  CHECK((records.find("\"end\":\"timed_out\"") != std::string::npos ||
         records.find("\"stop_reason\":\"deadline\"") != std::string::npos));
  CHECK(records.find("\"optimizer\":\"nlopt-slsqp\"") != std::string::npos);
}

TEST_CASE("problem files can take the place of the suite") {
  const Workshop shop;
  const Outcome outcome =
      shop.run(bench("'" + source_path("problems/planar_two_link_c2_a.yaml") +
                     "' --optimizers nlopt-slsqp,random-search --seeds 2 --budget 200"));
  INFO(outcome.err);
  CHECK(outcome.code == 0);
  CHECK(outcome.out.find("planar_two_link_c2_a/case") != std::string::npos);
}

TEST_CASE("bench refuses what makes no sense") {
  const Workshop shop;
  CHECK(shop.run(bench("--optimizers nlopt-slsqpp")).code == 2);
  CHECK(shop.run(bench("--optimizers nlopt-slsqp:tuned")).code == 2);
  CHECK(shop.run(bench("--select nowhere/nominal")).code == 2);
  CHECK(shop.run(bench("--budget 0")).code == 2);
  CHECK(shop.run(bench("--quick --seeds 3")).code == 2);
  CHECK(shop.run("bench --suite nothing.yaml").code == 3);
  CHECK(shop.run("report nothing.json").code == 3);
  CHECK(shop.run("report . -o r.html").code == 3);
  // A problem is not read as a bad plan, line by line.
  shop.write("problem.yaml", file_text(source_path("problems/planar_two_link_c2_a.yaml")));
  const Outcome problem = shop.run("report problem.yaml -o r.html");
  CHECK(problem.code == 3);
  CHECK(problem.says("this is a problem file; make a plan of it first"));
  CHECK(std::count(problem.err.begin(), problem.err.end(), '\n') == 1);
}

TEST_CASE("a plan and a benchmark become one HTML file each that needs nothing from outside") {
  const Workshop shop;
  REQUIRE(shop.run("plan '" + source_path("problems/planar_two_link_c2_a.yaml") + "' -o plan.json")
              .code == 0);
  REQUIRE(shop.run(bench("--select planar_two_link/case/0 --seeds 1 --budget 100 -o A")).code == 0);
  CHECK(shop.run("report plan.json -o plan.html").code == 0);
  CHECK(shop.run("report A -o bench.html").code == 0);
  CHECK(shop.run("report A -o bench.html").code == 7);
  for (const char* file : {"plan.html", "bench.html"}) {
    const std::string html = shop.text(file);
    CAPTURE(file);
    CHECK(html.find("<!DOCTYPE html>") == 0);
    CHECK(html.find("default-src 'none'") != std::string::npos);
  }
  CHECK(shop.text("plan.html").find("joint_2") != std::string::npos);
  CHECK(shop.text("bench.html").find("Where each wins") != std::string::npos);
}

TEST_CASE("approach planners leave a log for Planner Arena") {
  const Workshop shop;
  const std::string command = bench("--planners --seeds 2 -o A '" +
                                    source_path("problems/planar_two_link_c2_a.yaml") + "'");
  const Outcome outcome = shop.run(command);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const std::string log = shop.text("A/planners_planar_two_link_c2_a.log");
  CHECK(log.find("Experiment planar_two_link_c2_a\n") != std::string::npos);
  CHECK(log.find("6 planners\n") != std::string::npos);
  CHECK(log.find("geometric_rrt_connect\n") != std::string::npos);
  CHECK(log.find("2 runs\n") != std::string::npos);
}

TEST_CASE("problem files are compared without a suite, and only what ran is spoken of") {
  const Workshop shop;
  const std::string problem = "'" + source_path("problems/planar_two_link_c2_a.yaml") + "' ";
  const std::string small = "--optimizers nlopt-slsqp,ipopt --seeds 1 ";
  const Outcome solved = shop.run("bench " + small + "--budget 400 " + problem);
  INFO(solved.err);
  CHECK(solved.code == 0);
  CHECK(solved.out.find("andom search") == std::string::npos);
  const Outcome unsolved = shop.run("bench " + small + "--budget 1 " + problem);
  CHECK(unsolved.code == 0);
  CHECK(unsolved.out.find("By default") == std::string::npos);
  CHECK(unsolved.out.find("No run reached") != std::string::npos);
  CHECK(shop.run("bench --planners --seeds 1 " + problem).code == 0);
  const Outcome lost = shop.run("bench --quick");
  CHECK(lost.code == 3);
  CHECK(lost.says("state --suite or problem files"));
}

TEST_CASE("a tool finds the suite that was installed beside it") {
  const Workshop shop;
  REQUIRE(shop.run_script("mkdir -p bin share/stillbase/bench && cp '" STILLBASE_TOOL "' bin && "
                          "cp -r '" +
                          source_path("problems") + "' share/stillbase && cp '" +
                          source_path("bench/suite.yaml") + "' share/stillbase/bench")
              .code == 0);
  const Outcome outcome = shop.run_script(
      "bin/stillbase bench --select planar_two_link/case/0 --optimizers nlopt-slsqp --seeds 1 "
      "--budget 50");
  INFO(outcome.err);
  CHECK(outcome.code == 0);
}

TEST_CASE("a number of instances is kept, or refused where it cannot be") {
  const Workshop shop;
  const std::string small = "--optimizers nlopt-slsqp --seeds 1 --budget 5 ";
  const std::string problem = "'" + source_path("problems/planar_two_link_c2_a.yaml") + "' ";
  CHECK(shop.run(bench("--quick --instances 2")).code == 2);
  CHECK(shop.run("bench --instances 2 " + small + problem).code == 2);
  CHECK(
      shop.run(bench("--select spart/nominal --instances 2 " + small)).says("2 problems, 2 runs"));
  CHECK(shop.run(bench("--select spart/nominal/7 --instances 2 " + small)).says("1 problems"));
  CHECK(shop.run(bench("--select spart/nominal --instances 20 " + small)).says("spart has 15"));
}
