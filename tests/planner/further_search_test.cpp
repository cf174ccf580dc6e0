// Plans where no candidate of the first search keeps the limits after the impact.
#include <catch2/catch.hpp>

#include <algorithm>

#include <stillbase/audit/audit.hpp>
#include <stillbase/core/constants.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/plan/free_roll.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/planner/post_impact.hpp>
#include <stillbase/search/search.hpp>

#include "planner/choice.hpp"
#include "support/random_capture.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// A random capture whose joint rate limits are just below what the best candidates of its search
/// need after the impact.
CaptureProblem with_tight_rates(std::uint64_t number) {
  CaptureProblem problem = random_capture(number);
  problem.search.starts = 16;
  problem.search.max_candidates = 8;
  problem.post_impact.controllers = {"none"};
  problem.post_impact.horizon = 0.05;
  problem.post_impact.residual_base_rate_max = 1e3;
  problem.post_impact.attitude_change_max = 3.14;
  SearchOptions options;
  options.starts = problem.search.starts;
  options.max_candidates = problem.search.max_candidates;
  double needed = kInfinity;  // of the rate limits
  for (const Candidate& candidate : search(problem, Formulation(problem), options).candidates) {
    const ImpactSummary impact = impact_at(problem, candidate.configuration);
    double most = 0;
    for (int k = 0; k < problem.robot.n(); ++k) {
      const double limit = problem.robot.joints[static_cast<std::size_t>(k)].max_velocity;
      most = std::max(most, std::abs(impact.Delta_phidot[k]) / limit);
    }
    needed = std::min(needed, most);
  }
  for (Joint& joint : problem.robot.joints) joint.max_velocity *= 0.8 * needed;
  return problem;
}

std::string failure_after(const Plan& plan) {
  return post_impact_failure(plan.problem, plan.configuration,
                             impact_at(plan.problem, plan.configuration), {});
}

}  // namespace

TEST_CASE("a search whose candidates all break a limit after the impact goes on") {
  // Of problem 3 rates at their limits right after the impact exceed them as the arm moves on.
  for (const std::uint64_t number : {0, 1, 2, 3, 6}) {
    const CaptureProblem problem = with_tight_rates(number);
    INFO("problem " << number);
    PlannerOptions once;
    once.further_searches = 0;
    CHECK_FALSE(failure_after(make_plan(problem, once)).empty());
    const Plan plan = make_plan(problem);
    CHECK(failure_after(plan).empty());
    CHECK(plan.candidates.size() <= 8);
    for (const Claim& claim : judge_plan(plan).claims) {
      INFO(claim.name << ": " << claim.detail);
      CHECK_FALSE(claim.fails());
    }
  }
}

TEST_CASE("free rolls and curves of zeros of further candidates are stated") {
  CaptureProblem rolled = test::shipped("deos_latch");
  rolled.search.starts = 6;
  rolled.approach.enabled = false;
  for (Joint& joint : rolled.robot.joints) joint.max_velocity = 0.3 * kPi / 180;
  CaptureProblem curved = test::shipped("detumble_client_1000");
  curved.search.starts = 6;
  curved.search.optimizer = "nlopt-slsqp";  // from these starts it finds nothing that holds
  curved.base.position = Vector3d(-2.413, 0.6075, 0.3246);
  curved.base.orientation =
      Eigen::AngleAxisd(68.41 * kPi / 180, Vector3d(0.1651, 0.9756, -0.1447).normalized());
  curved.variables.base_attitude = AttitudeFreedom::Fixed;
  curved.approach.base = BaseMode::Held;
  curved.post_impact.wheels.preset = Vector3d(3, 0, -3);
  for (const CaptureProblem& problem : {rolled, curved}) {
    INFO(problem.name);
    const Plan plan = make_plan(problem);
    CHECK(plan.certificate.starts > problem.search.starts);
    const auto chosen = std::find_if(plan.candidates.begin(), plan.candidates.end(), [&](auto& c) {
      return is_same_configuration(c.configuration, plan.configuration);
    });
    REQUIRE(chosen != plan.candidates.end());
    REQUIRE(chosen->family >= 0);
    const SolutionFamily& family = plan.families[static_cast<std::size_t>(chosen->family)];
    CHECK(free_joint(family).has_value() == (problem.name == rolled.name));
    for (const Claim& claim : judge_plan(plan).claims) {
      INFO(claim.name << ": " << claim.detail);
      CHECK_FALSE(claim.fails());
    }
  }
}

TEST_CASE("a limit that no configuration keeps at the impact is no fault of the search") {
  for (const std::uint64_t number : {4, 5, 7}) {
    INFO("problem " << number);
    CaptureProblem problem = with_tight_rates(number);
    CHECK_FALSE(failure_after(make_plan(problem)).empty());
    problem.constraints.joint_rate_scale = 1;
    SearchOptions many;
    many.starts = 128;
    many.seed = 99;
    CHECK(search(problem, Formulation(problem), many).status == PlanStatus::Infeasible);
  }
}

}  // namespace stillbase
