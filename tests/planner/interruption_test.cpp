#include <catch2/catch.hpp>

#include <atomic>

#include <stillbase/io/plan_file.hpp>
#include <stillbase/planner/planner.hpp>

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
