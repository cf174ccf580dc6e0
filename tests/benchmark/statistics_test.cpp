// Figures of small tables, worked out by hand.
#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include <stillbase/benchmark/statistics.hpp>

namespace stillbase {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

Runtime runtime(std::vector<double> to_target, double spent) { return {to_target, spent}; }

}  // namespace

TEST_CASE("there are 51 precisions from one to 1e-8, evenly spaced in the logarithm") {
  const auto precisions = benchmark_precisions();
  REQUIRE(precisions.size() == 51);
  CHECK(precisions.front() == 1);
  CHECK(precisions.back() == Approx(1e-8).epsilon(1e-12));
  for (std::size_t i = 1; i < precisions.size(); ++i) {
    CHECK(precisions[i] / precisions[i - 1] == Approx(std::pow(10, -0.16)).epsilon(1e-12));
  }
}

TEST_CASE(
    "a target is reached by the first point that is good enough and satisfies the constraints") {
  RunRecord record;
  record.evaluations = 100;
  record.gradients = 40;
  record.improvements = {{2, 1, 0.5, 1e-2, 0},   // good, but violated
                         {10, 4, 3.0, 0, 0},     // satisfied, not good
                         {20, 8, 1.9, 1e-6, 0},  // just satisfied
                         {50, 20, 1.05, 0, 0}};
  const Runtime out = runtime_of(record, 1.0, {1.0, 0.1, 0.01}, 0.5);
  CHECK(out.to_target == std::vector<double>{24, 60, kNever});
  CHECK(out.spent == 120);
  // 50 evaluations and 20 gradients cost 60: more than the budget.
  record.request.budget = 59;
  const Runtime cut = runtime_of(record, 1.0, {1.0, 0.1, 0.01}, 0.5);
  CHECK(cut.to_target == std::vector<double>{24, kNever, kNever});
  CHECK(cut.spent == 59);
}

TEST_CASE("expected running time counts what failures spent") {
  const std::vector<Runtime> runs = {runtime({10}, 50), runtime({kNever}, 30), runtime({20}, 99)};
  CHECK(expected_running_time(runs, 0) == 30);
  CHECK(expected_running_time({runtime({kNever}, 30)}, 0) == kNever);
  CHECK(expected_running_time({}, 0) == kNever);
}

TEST_CASE("the distribution of runtimes counts pairs of run and target per variable") {
  const std::vector<Runtime> runs = {runtime({10, 40}, 50), runtime({20, kNever}, 90)};
  const auto part = runtime_distribution(runs, {2, 4}, {4, 5, 20, 1e9});
  CHECK(part == std::vector<double>{0, 0.5, 0.75, 0.75});
}

TEST_CASE("a data profile counts problems solved within multiples of n + 1") {
  const CostTable costs = {{30, 3}, {kNever, 40}};
  const auto profile = data_profile(costs, {2, 9}, {1, 4, 10, 1e12});
  CHECK(profile[0] == std::vector<double>{0, 0, 0.5, 0.5});
  CHECK(profile[1] == std::vector<double>{0.5, 1, 1, 1});
}

TEST_CASE("a performance profile compares with the best, and nobody solves what nobody solved") {
  const CostTable costs = {{10, 20}, {kNever, 8}, {kNever, kNever}, {6, 3}};
  const auto profile = performance_profile(costs, {1, 2, 100});
  CHECK(profile[0] == std::vector<double>{0.25, 0.5, 0.5});
  CHECK(profile[1] == std::vector<double>{0.5, 0.75, 0.75});
}

TEST_CASE("the bootstrap interval holds the mean, has no width without scatter, and repeats") {
  std::vector<double> scatter;
  for (int i = 0; i < 40; ++i) scatter.push_back(i % 4 == 0 ? 1 : 0);
  const auto interval = bootstrap_mean(scatter, 7);
  CHECK(interval.value == Approx(0.25).epsilon(1e-14));
  // Standard error sqrt(0.25 * 0.75 / 40) = 0.0685; 1.96 of them on each side.
  CHECK(interval.low == Approx(0.25 - 0.134).epsilon(0).margin(0.03));
  CHECK(interval.high == Approx(0.25 + 0.134).epsilon(0).margin(0.03));
  const auto again = bootstrap_mean(scatter, 7);
  CHECK(again.low == interval.low);
  const auto flat = bootstrap_mean({2, 2, 2}, 1);
  CHECK(flat.low == 2);
  CHECK(flat.high == 2);
  CHECK(bootstrap_mean({}, 1).value == 0);
}

}  // namespace stillbase
