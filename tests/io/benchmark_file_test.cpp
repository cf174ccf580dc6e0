// Records, requests, best known values and suites as files.
#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/benchmark_file.hpp>

#include "io/io_support.hpp"
#include "support/temporary_folder.hpp"

namespace stillbase {
namespace {

RunRecord example() {
  RunRecord record;
  record.request = {"arm/nominal/0", "abc", "nlopt-slsqp", true, 18446744073709551615ull, 500, 7.5};
  record.family = "arm";
  record.goal = "nominal";
  record.variables = 3;
  record.equations = 2;
  record.library = "NLopt";
  record.options = "ftol_rel 1e-15";
  record.end = RunEnd::TimedOut;
  record.stop_reason = "deadline";
  record.message = "a \"quoted\" text";
  record.evaluations = 499;
  record.gradients = 400;
  record.hessians = 3;
  record.starts = 4;
  record.distinct_solutions = 2;
  record.seconds = 0.125;
  record.improvements = {{1, 1, 0.1 + 0.2, 0.5, 0.001}, {7, 6, 1e-300, 0, 0.002}};
  record.best_point = {1.0 / 3, -2};
  record.best_kkt_residual = 1e-9;
  return record;
}

}  // namespace

TEST_CASE("a record reads back the same, and so does the request in it") {
  const std::string text = record_to_text(example(), "host");
  CHECK(text.find('\n') == std::string::npos);
  const auto records = read_records(text + "\n" + text, "records");
  REQUIRE(records.size() == 2);
  CHECK(record_to_text(records[0], "host") == text);
  const RunRequest request = request_from_text(request_to_text(example().request));
  CHECK(request_to_text(request) == request_to_text(example().request));
  CHECK(label_of(request) == "nlopt-slsqp:defaults");
}

TEST_CASE("counts of evaluations that are no whole numbers in range are refused") {
  const std::string good = record_to_text(example(), "host");
  for (const char* count : {"1e300", "-1e300", "7.5", "-1"}) {
    std::string text = good;
    text.replace(text.find("[7,6,"), 3, "[" + std::string(count) + ",");
    INFO(count);
    CHECK_THROWS_AS(read_records(text, "records.jsonl"), InputError);
  }
}

TEST_CASE("lines that are no records are named with their numbers") {
  const std::string good = record_to_text(example(), "host");
  std::string other_end = good;
  other_end.replace(other_end.find("timed_out"), 9, "vanished!");
  try {
    (void)read_records(good + "\n{}\n" + other_end + "\nnot json\n", "records.jsonl");
    FAIL("accepted");
  } catch (const InputError& error) {
    REQUIRE(error.findings().size() == 3);
    CHECK(error.findings()[0].line == 2);
    CHECK(error.findings()[1].line == 3);
    CHECK(error.findings()[2].line == 4);
  }
  CHECK_THROWS_AS(request_from_text("{\"instance\": 1}"), InputError);
}

TEST_CASE("best known values change only when they are beaten, and read back the same") {
  BestKnownTable table;
  RunRecord record = example();
  record.improvements.back().value = 0.5;
  CHECK(improve(table, {record}) == 1);
  CHECK(table.at("arm/nominal/0").value == 0.5);
  CHECK(table.at("arm/nominal/0").command.find("--select arm/nominal/0") != std::string::npos);
  const std::string text = best_known_to_json(table);
  CHECK(best_known_to_json(read_best_known(text, "file")) == text);

  RunRecord same = record, violated = record, better = record;
  same.improvements.back().value = 0.5 - 1e-11;
  violated.improvements.back().value = 0.1;
  violated.improvements.back().violation = 2e-9;
  CHECK(improve(table, {same, violated}) == 0);
  CHECK(best_known_to_json(table) == text);
  better.improvements.back().value = 0.4;
  CHECK(improve(table, {better}) == 1);
  CHECK(table.at("arm/nominal/0").value == 0.4);
}

TEST_CASE("a file of best known values with a violated point is refused") {
  BestKnownTable table;
  RunRecord record = example();
  (void)improve(table, {record});
  table.begin()->second.violation = 1e-3;
  CHECK_THROWS_AS(read_best_known(best_known_to_json(table), "file"), InputError);
  CHECK_THROWS_AS(read_best_known("{}", "file"), InputError);
}

TEST_CASE("a suite with mistakes is refused with all of them") {
  const std::string text =
      "format: stillbase.suite\nversion: 1\ngradient_cost: -1\nfamilies:\n"
      "  - name: a\n    problem: " STILLBASE_SOURCE_DIR
      "/problems/spart_3dof_point.yaml\n    goals: [nominal, worst_case, best]\n"
      "    vary: [impulse_direction, impulse_direction]\n    instances: 0\n    colour: red\n";
  const TemporaryFolder folder;
  try {
    (void)read_suite(folder.write("suite.yaml", text));
    FAIL("accepted");
  } catch (const InputError& error) {
    const std::string what = error.what();
    for (const char* part : {":3:", "best", "twice", "cone_half_angle", "instances", "colour"}) {
      CAPTURE(what, part);
      CHECK(what.find(part) != std::string::npos);
    }
  }
}

}  // namespace stillbase
