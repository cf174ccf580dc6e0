// The shipped suite: enough problems, the same on every machine, each of them solvable.
#include <catch2/catch.hpp>

#include <set>

#include <stillbase/benchmark/run.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/benchmark_file.hpp>
#include <stillbase/nlp/optimizer.hpp>

namespace stillbase {
namespace {

const std::string kSuite = STILLBASE_SOURCE_DIR "/bench/suite.yaml";

const FamilySpec& family_of(const SuiteSpec& suite, std::string_view name) {
  for (const FamilySpec& family : suite.families) {
    if (family.name == name) return family;
  }
  throw std::invalid_argument(std::string(name));
}

}  // namespace

TEST_CASE("the suite has the families, the instances and the optimizers that it promises") {
  const SuiteSpec suite = read_suite(kSuite);
  std::set<std::string> robots;
  int kinds = 0;
  for (const FamilySpec& family : suite.families) {
    robots.insert(family.problem.urdf_path);
    CHECK(family.instances == 15);
    kinds += static_cast<int>(family.goals.size());
  }
  CHECK(robots.size() == 6);
  CHECK(kinds * 5 >= 60);  // five instances of each kind is what the command runs unasked
  CHECK(nlp::optimizer_names().size() >= 14);
}

TEST_CASE("an instance depends on nothing but family, goal and number") {
  const SuiteSpec suite = read_suite(kSuite);
  for (const char* name : {"planar_three_link", "spart", "iiwa_free_base", "ets7"}) {
    const FamilySpec& family = family_of(suite, name);
    const auto third = make_instance(family, BenchmarkGoal::Nominal, 3);
    (void)make_instance(family, BenchmarkGoal::Nominal, 1);
    CHECK(instance_sha256(make_instance(family, BenchmarkGoal::Nominal, 3)) ==
          instance_sha256(third));
    CHECK(instance_sha256(make_instance(family, BenchmarkGoal::Nominal, 4)) !=
          instance_sha256(third));
    // The goals of one number meet the same encounter.
    const auto worst = make_instance(family, BenchmarkGoal::WorstCase, 3);
    CHECK(worst.problem.target_state.pose.orientation.coeffs() ==
          third.problem.target_state.pose.orientation.coeffs());
    CHECK(worst.problem.impulse.direction == third.problem.impulse.direction);
  }
}

TEST_CASE("best known values are what their points are worth, by our own evaluation") {
  const SuiteSpec suite = read_suite(kSuite);
  const BestKnownTable table = read_best_known(read_text_file(suite.best_known), suite.best_known);
  CHECK(table.size() >= 60);
  int seen = 0;
  for (const FamilySpec& family : suite.families) {
    for (const BenchmarkGoal goal : family.goals) {
      // One instance of each kind; the file has them all.
      const BenchmarkInstance instance = make_instance(family, goal, 2);
      const auto known = table.find(instance.name);
      CAPTURE(instance.name);
      if (known == table.end()) continue;
      ++seen;
      const Judged judged = judge_point(instance, known->second.point);
      CHECK(judged.value == Approx(known->second.value).epsilon(1e-9).margin(1e-11));
      CHECK(judged.violation <= kBenchmarkViolation);
    }
  }
  CHECK(seen >= 12);
}

}  // namespace stillbase
