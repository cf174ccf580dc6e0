#include <catch2/catch.hpp>

#include <atomic>

#include <stillbase/encounter/encounter.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/planner/planner.hpp>

#include "planner/candidates.hpp"
#include "support/shipped_problem.hpp"

using namespace stillbase;

TEST_CASE("an approach that a signal ends is interrupted, not out of time") {
  const CaptureProblem problem = test::shipped("planar_two_link_c2_a");
  std::atomic<bool> interrupted{false};
  PlannerOptions options;
  options.stop.interrupted = &interrupted;
  options.on_progress = [&](const std::string& what, int, int) {
    if (what == "approach") interrupted = true;
  };
  const Plan plan = make_plan(problem, options);
  CHECK(plan.approach.status == ApproachStatus::Interrupted);
  const std::string text = plan_to_json(plan, {});
  CHECK(text.find("\"interrupted\"") != std::string::npos);
  CHECK(read_plan(text, "plan.json").plan.approach.status == ApproachStatus::Interrupted);
}

TEST_CASE("a plan that a stop cuts short is no complete one, whatever the search found") {
  CaptureProblem problem = test::shipped("planar_two_link_c2_a");
  std::atomic<bool> interrupted{false};
  PlannerOptions options;
  options.jobs = 1;
  options.stop.interrupted = &interrupted;
  std::string stopped_at;
  options.on_progress = [&](const std::string& what, int, int) {
    if (what == stopped_at) interrupted = true;
  };
  CHECK(make_plan(problem, options).status == PlanStatus::Optimal);
  SECTION("before the time after the impact is judged") {
    problem.approach.enabled = false;
    stopped_at = "after the impact";
  }
  SECTION("before a path is found") { stopped_at = "approach"; }
  SECTION("before a path is found, where nothing follows") {
    problem.post_impact.controllers.clear();
    stopped_at = "approach";
  }
  const Plan plan = make_plan(problem, options);
  CHECK(interrupted);
  CHECK(plan.status == PlanStatus::Limit);
  CHECK(!plan.candidates.empty());
}

TEST_CASE("what comes after a stop is not judged") {
  const CaptureProblem problem = test::shipped("iiwa_client_50");
  const CollisionJudge collisions(problem);
  Candidate candidate;
  candidate.configuration = start_configuration(problem);
  std::vector<Candidate> candidates(3, candidate);
  std::atomic<bool> interrupted{false};
  StopCondition stop;
  stop.interrupted = &interrupted;

  collisions.judge_all(1, stop, candidates);
  CHECK(candidates.front().collision != "not judged");
  AfterImpactJudge after(problem, stop, 1, nullptr);
  const std::string before = after.failure(candidate.configuration);
  CHECK(before != "not judged");

  interrupted = true;
  collisions.judge_all(1, stop, candidates);
  for (const Candidate& one : candidates) {
    CHECK(one.collision == "not judged");
    CHECK_FALSE(one.collision_free);
  }
  CHECK(after.failure(candidate.configuration) == before);
  candidate.configuration.phi[0] += 0.1;
  CHECK(after.failure(candidate.configuration) == "not judged");
}
