// A recorded stream of estimates played to a plan.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::json;

namespace {

const std::string kStream = source_path("problems/streams/iiwa_client_50.csv");

/// A plan of the shipped client without path.
void make_plan(const Workshop& shop) {
  shop.write_changed("client.yaml", "problems/iiwa_client_50.yaml", "approach:\n",
                     "approach:\n  enabled: false\n");
  const Outcome made = shop.run("plan client.yaml --starts 8 -o plan.json");
  INFO(made.err);
  REQUIRE(made.code == 0);
}

/// The comments, the header and the first `count` estimates of the shipped stream.
std::string head_of_stream(int count) {
  const std::string text = file_text(kStream);
  std::size_t end = 0;
  for (int line = 0; line < count + 3; ++line) end = text.find('\n', end) + 1;
  return text.substr(0, end);
}

}  // namespace

TEST_CASE("replan prints a screen of updates, their feasibility and latencies") {
  const Workshop shop;
  make_plan(shop);
  const Outcome outcome = shop.run("replan plan.json --estimates '" + kStream + "'");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(std::count(outcome.out.begin(), outcome.out.end(), '\n') <= 24);
  CHECK(outcome.out.find("feasible    226 of 226 updates\n") != std::string::npos);
  CHECK(outcome.out.find("   45.00 ") != std::string::npos);
  CHECK(outcome.out.find("\nafterwards  the last posture ") != std::string::npos);
  CHECK(outcome.says("latency     median "));
  CHECK(outcome.says("0 of 226 cut"));
}

TEST_CASE("replan writes every update, the same bytes each time") {
  const Workshop shop;
  make_plan(shop);
  shop.write("stream.csv", head_of_stream(12));
  const std::string command = "replan plan.json --estimates stream.csv ";
  REQUIRE(shop.run(command + "-o a.json").code == 0);
  REQUIRE(shop.run(command + "-o b.json").code == 0);
  CHECK(shop.text("a.json") == shop.text("b.json"));
  CHECK(shop.run(command + "-o b.json").code == 7);  // not without --force
  const json record = json::parse(shop.text("a.json"));
  CHECK(record.at("format") == "stillbase.replan");
  REQUIRE(record.at("updates").size() == 12);
  for (const json& update : record.at("updates")) {
    CHECK(update.at("status") == "optimal");
    CHECK(update.at("max_violation").get<double>() <= 1e-9);
    CHECK(update.at("value").get<double>() <=
          update.at("corrected").at("value").get<double>() * (1 + 1e-12));
    CHECK_FALSE(update.contains("seconds"));
  }
  const std::string after = record.at("after_impact");
  CHECK(after.rfind("keeps the limits after the impact", 0) == 0);
  CHECK(json::parse(shop.run(command + "--json").out) == record);
  REQUIRE(shop.run(command + "-o a.csv").code == 0);
  const std::string csv = shop.text("a.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 13);
  CHECK(csv.rfind("time_s,status,cut,old_value,", 0) == 0);
  CHECK(csv.find("seconds") == std::string::npos);
  CHECK(csv.find(",\"" + after + "\",") > csv.rfind('\n', csv.size() - 2));  // of the last one
  REQUIRE(shop.run(command + "--timing -o timed.csv").code == 0);
  CHECK(shop.text("timed.csv").find(",steps,seconds\n") != std::string::npos);
}

TEST_CASE("replan ends with the exit code of what it found") {
  const Workshop shop;
  make_plan(shop);
  shop.write("stream.csv", head_of_stream(4));
  const std::string command = "replan plan.json --estimates stream.csv ";
  CHECK(shop.run(command + "--deadline 10s").code == 0);
  // No update is done in a nanosecond: the old posture on the constraints is taken.
  const Outcome cut = shop.run(command + "--deadline 1e-9 -o cut.json");
  CHECK(cut.code == 6);
  CHECK(cut.says("4 of 4 cut"));
  CHECK(json::parse(shop.text("cut.json")).at("updates").at(3).at("status") == "feasible");
  // A target that leaves has no contact.
  std::string away = head_of_stream(1);
  const std::size_t at = away.find("-0.04964967");
  REQUIRE(at != std::string::npos);
  shop.write("away.csv", away.replace(at, 1, ""));
  const Outcome lost = shop.run("replan plan.json --estimates away.csv -o lost.json");
  CHECK(lost.code == 4);
  CHECK(lost.out.find("feasible    0 of 1 updates; infeasible at 0 s: ") != std::string::npos);
  CHECK(json::parse(shop.text("lost.json")).at("updates").at(0).at("status") == "infeasible");
}

TEST_CASE("replan refuses wrong input with its place") {
  const Workshop shop;
  make_plan(shop);
  shop.write("stream.csv", head_of_stream(2) + "1,2,3\n");
  const Outcome outcome = shop.run("replan plan.json --estimates stream.csv");
  CHECK(outcome.code == 3);
  CHECK(outcome.says("stream.csv:6: columns: has 3 values, the first line names 26"));
  CHECK(shop.run("replan plan.json").code == 2);
  CHECK(shop.run("replan plan.json --estimates none.csv").code == 3);
  CHECK(shop.run("replan plan.json --estimates stream.csv --stay-within 5s")
            .says("--stay-within 5s: must be a number in (0, 3e+07], alone or with one of the "
                  "units rad, deg"));
  for (const char* wrong : {"0", "-1", "10 m", "fast", "nan"}) {
    INFO(wrong);
    const Outcome refused =
        shop.run(std::string("replan plan.json --estimates stream.csv --deadline '") + wrong + "'");
    CHECK(refused.code == 2);
    CHECK(refused.says("--deadline"));
  }
  shop.write("stream.csv", head_of_stream(2));
  CHECK(shop.run("replan plan.json --estimates stream.csv -o out.txt").code == 2);
  CHECK(shop.run("replan plan.json --estimates stream.csv -o stream.csv --force").code == 2);
  CHECK(shop.run("plan '" + source_path("problems/planar_two_link_c2_a.yaml") +
                 "' --starts 8 -o stated.json")
            .code == 0);
  const Outcome stated = shop.run("replan stated.json --estimates stream.csv");
  CHECK(stated.code == 3);
  CHECK(stated.says(": not-replannable: problem.impact.direction: "));
  const std::string plan = shop.text("stated.json");
  const auto at = static_cast<long>(plan.find("\"direction\"", plan.find("\"impact\": {")));
  const auto line = 1 + std::count(plan.begin(), plan.begin() + at, '\n');
  CHECK(stated.says("stated.json:" + std::to_string(line) + ": "));
}

TEST_CASE("the shipped stream is what its script makes") {
  const Workshop shop;
  if (shop.run_script("command -v python3").code != 0) {
    WARN("no python3: the script is not run");
    return;
  }
  const Outcome made = shop.run_script("python3 '" + source_path("tools/make-estimates") + "'");
  REQUIRE(made.code == 0);
  CHECK(made.out == file_text(kStream));
}

TEST_CASE("a signal ends a replay, and the updates until then are saved") {
  const Workshop shop;
  make_plan(shop);
  // The stream a hundred times over in steps of a millisecond: more than ten seconds of work.
  const std::string repeat =
      "awk -F, -v OFS=, '/^[#t]/ {print; next} {row[n++] = $0} END {"
      "for (i = 0; i < 100 * n; ++i) {$0 = row[i % n]; $1 = i / 1000; print}}' '" +
      kStream + "' >long.csv\n";
  const Outcome outcome = shop.run_script(
      repeat + "'" STILLBASE_TOOL "' replan plan.json --estimates long.csv -o out.csv &\npid=$!\n" +
      "sleep 3\nkill -INT $pid\nwait $pid");
  INFO(outcome.err);
  CHECK(outcome.code == 130);
  REQUIRE(shop.has("out.csv"));
  const std::string text = shop.text("out.csv");
  const auto lines = std::count(text.begin(), text.end(), '\n');
  CHECK(lines > 1);
  CHECK(lines < 22601);
}
