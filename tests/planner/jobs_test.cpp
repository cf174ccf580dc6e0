// Every number of threads gives the same plan, byte for byte.
#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <set>
#include <string>
#include <thread>

#include <stillbase/io/plan_file.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/search/search.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

using test::shipped;

Plan planned_by(const CaptureProblem& problem, int jobs) {
  PlannerOptions options;
  options.jobs = jobs;
  return make_plan(problem, options);
}

std::string bytes_of(Plan plan) {
  plan.timing.clear();
  return plan_to_json(plan, {});
}

}  // namespace

// Among them isolated solutions with their proof, a bound, zeros on curves, worst cases over a
// cone, CVaR over samples, a path in the reaction null space and paths to many forms of candidates.
TEST_CASE("a plan does not depend on the number of threads") {
  const std::string name = GENERATE(
      "planar_two_link_c2_a", "planar_three_link_null", "planar_three_link_client", "iiwa_cone",
      "planar_three_link_cvar", "servicer_6dof_held", "spart_g2", "ets7_envisat");
  CAPTURE(name);
  const CaptureProblem problem = shipped(name);
  const std::string alone = bytes_of(planned_by(problem, 1));
  CHECK(bytes_of(planned_by(problem, 2)) == alone);
  CHECK(bytes_of(planned_by(problem, 5)) == alone);
}

TEST_CASE("features are planned for beside each other without a trace but their time") {
  CaptureProblem problem = shipped("deos_features");
  problem.search.starts = 24;
  problem.search.max_candidates = 16;
  const Plan one_by_one = planned_by(problem, 1);
  const std::string alone = bytes_of(one_by_one);
  REQUIRE(one_by_one.candidates.size() > 1);
  for (const int jobs : {2, 5}) {
    PlannerOptions options;
    options.jobs = jobs;
    PhaseClock clock;
    options.clock = &clock;
    int searches = 0, last = 0, at_once = 0;
    std::atomic<int> inside{0};
    options.on_progress = [&](const std::string& stage, int done, int) {
      at_once = std::max(at_once, ++inside);
      if (stage == "search") {
        searches += done < last || searches == 0;
        last = done;
      }
      --inside;
    };
    const auto begin = std::chrono::steady_clock::now();
    const Plan plan = make_plan(problem, options);
    const double wall =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    CHECK(bytes_of(plan) == alone);
    CHECK(at_once == 1);
    CHECK(searches <= 2);  // those of a feature that ends second are seen from then on
    CHECK(plan.timing.at("total") <= wall);
    double phases = 0;
    for (const auto& [name, seconds] : clock.seconds()) phases += seconds.wall;
    CHECK(phases <= wall);
    CHECK(phases > 0.5 * plan.timing.at("total"));
  }
}

// What is hopeless is known from earlier starts: with several threads from some of them.
TEST_CASE("rounds of further starts do not depend on the number of threads") {
  for (const std::uint64_t seed : {1, 2}) {
    CaptureProblem problem = test::without_path("iiwa_cone");
    problem.search.starts = kAutomaticStarts;
    problem.search.seed = seed;
    const std::string alone = bytes_of(planned_by(problem, 1));
    CHECK(bytes_of(planned_by(problem, 2)) == alone);
    CHECK(bytes_of(planned_by(problem, 5)) == alone);
  }
}

TEST_CASE("functions of the user are called on the thread that plans") {
  CaptureProblem problem = test::without_path("planar_three_link_client");
  const std::thread::id here = std::this_thread::get_id();
  int calls = 0;
  int elsewhere = 0;
  UserConstraint limit{"first_joint", "rad", -3, 3, {}};
  limit.value = [&](const Configuration& at, const ImpactSummary&) {
    ++calls;
    elsewhere += std::this_thread::get_id() != here;
    return at.phi[0];
  };
  problem.user.constraints.push_back(limit);
  CHECK(planned_by(problem, 4).status != PlanStatus::Infeasible);
  CHECK(calls > 0);
  CHECK(elsewhere == 0);
}

TEST_CASE("the phases of a plan add up to no more than its time") {
  const Plan plan = planned_by(shipped("planar_three_link_client"), 1);
  double parts = 0;
  for (const auto& [phase, seconds] : plan.timing) {
    CHECK(seconds >= 0);
    const bool is_sum = std::set<std::string>{"search", "proof", "approach", "total"}.count(phase);
    if (!is_sum) parts += seconds;
  }
  CHECK(parts > 0.5 * plan.timing.at("total"));
  CHECK(parts <= plan.timing.at("total"));
  for (const char* phase : {"search.starts", "search.ranking", "collision", "after_impact",
                            "approach.path", "approach.check"}) {
    CAPTURE(phase);
    CHECK(plan.timing.count(phase) == 1);
  }
}

}  // namespace stillbase
