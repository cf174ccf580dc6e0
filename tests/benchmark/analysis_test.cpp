// Rankings, wins and comparisons of a few records, worked out by hand.
#include <catch2/catch.hpp>

#include <cmath>

#include <stillbase/benchmark/analysis.hpp>

namespace stillbase {
namespace {

/// A run of 100 evaluations that reaches a value after some of them.
RunRecord run(const std::string& optimizer, int instance, std::uint64_t seed, double value,
              long after, bool library_defaults = false) {
  RunRecord record;
  record.request.instance = "f/nominal/" + std::to_string(instance);
  record.request.optimizer = optimizer;
  record.request.library_defaults = library_defaults;
  record.request.seed = seed;
  record.family = "f";
  record.goal = "nominal";
  record.variables = 2;
  record.evaluations = 100;
  record.distinct_solutions = 3;
  record.seconds = 0.5;
  record.improvements = {{after, 0, value, 0, 0}};
  return record;
}

}  // namespace

TEST_CASE(
    "references are the known values or what beats them; points that are not exact beat nothing") {
  RunRecord violated = run("a", 0, 1, 0.1, 5);
  violated.improvements[0].violation = 5e-7;
  const auto out = reference_values({violated, run("a", 0, 2, 0.5, 5), run("a", 1, 1, 2, 5)},
                                    {{"f/nominal/0", 0.7}, {"f/nominal/1", 1.5}});
  CHECK(out.at("f/nominal/0") == 0.5);
  CHECK(out.at("f/nominal/1") == 1.5);
}

TEST_CASE("the optimizer that solves more comes first, and wins where its running time is less") {
  const std::vector<RunRecord> records = {
      // a: slow, always; b: fast, every other seed; random-search never.
      run("b", 0, 1, 1, 10),
      run("b", 0, 2, 2, 10),
      run("b", 1, 1, 1, 10),
      run("b", 1, 2, 9, 10),
      run("a", 0, 1, 1, 60),
      run("a", 0, 2, 1, 60),
      run("a", 1, 1, 1, 60),
      run("a", 1, 2, 1, 60),
      run("random-search", 0, 1, 1.5, 3),
      run("random-search", 1, 1, 1.5, 3),
      run("random-search", 2, 1, 1.0 + 1e-3, 3),
      run("a", 0, 1, 1.5, 60, true)};
  const auto out =
      analyze_benchmark(records, {{"f/nominal/0", 1}, {"f/nominal/1", 1}, {"f/nominal/2", 1}}, 0.5);
  CHECK(out.problems == 3);
  CHECK(out.seeds == 2);
  REQUIRE(out.optimizers.size() == 3);
  CHECK(out.optimizers[0].optimizer == "a");
  CHECK(out.optimizers[0].solved.back().value == 1);
  CHECK(out.optimizers[0].by_family.at("f") == 1);
  CHECK(out.optimizers[1].optimizer == "b");
  CHECK(out.optimizers[1].solved.back().value == 0.5);
  CHECK(out.optimizers[1].running_time.back()[0] == (10 + 100 + 10 + 100) / 2.0);
  CHECK(out.optimizers[1].distinct_per_1000 == 30);
  CHECK(out.optimizers[1].distinct_per_second == 6);
  CHECK(out.problems_by_random_search == 0);
  CHECK(out.solved_by_nobody == std::vector<std::string>{"f/nominal/2"});

  REQUIRE(out.wins.size() == 3);
  const Win& tight = out.wins.back();
  CHECK(tight.best == "a");
  CHECK(tight.running_time == 60);
  CHECK(tight.second == "b");
  CHECK(tight.second_running_time == 110);
  // b wins a resampling of four pairs when three or more of its draws are its good seed, 5/16:
  // then 10 + 100 / 3 < 60.
  CHECK(tight.sure == Approx(11.0 / 16).epsilon(0).margin(0.12));
  CHECK(out.wins.front().best == "a");

  REQUIRE(out.defaults.size() == 1);
  CHECK(out.defaults[0].pairs == 1);
  CHECK(out.defaults[0].tuned == 1);
  CHECK(out.defaults[0].defaults == 0);

  // The profiles end at the solved parts: pairs (0,1) (0,2) (1,1) (1,2) (2,1).
  CHECK(out.optimizers[0].data_profile.value.back() == 0.8);
  // Of three problems two are solved: one resampling in 27 draws the third alone, 8 in 27 never.
  CHECK(out.optimizers[0].data_profile.low.back() == 0);
  CHECK(out.optimizers[0].data_profile.high.back() == 1);
  for (const OptimizerFigures& figures : out.optimizers) {
    for (const ShareCurve* curve :
         {&figures.runtime_ecdf, &figures.data_profile, &figures.performance_profile}) {
      REQUIRE(curve->low.size() == curve->value.size());
      for (std::size_t i = 0; i < curve->value.size(); ++i) {
        CHECK(curve->low[i] <= curve->value[i]);
        CHECK(curve->value[i] <= curve->high[i]);
      }
    }
  }
  CHECK(out.optimizers[0].performance_profile.value.front() == 0.4);
  CHECK(out.optimizers[1].performance_profile.value.front() == 0.4);
  CHECK(out.optimizers[1].performance_profile.value.back() == 0.4);
}

}  // namespace stillbase
