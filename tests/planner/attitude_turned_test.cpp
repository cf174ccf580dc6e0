#include <catch2/catch.hpp>

#include <atomic>
#include <cmath>

#include <stillbase/audit/audit.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/objective.hpp"

namespace stillbase {
namespace {

/// The paper's robot of two links, impact along 210 deg, both joints free: the rotation within two
/// seconds of joint damping is made small.
CaptureProblem turning_problem() {
  CaptureProblem problem = test::shipped("planar_two_link_c2_a");
  problem.constraints.impact_case = CaseConstraint::None;
  problem.uncertainty = {};
  problem.objective = {{ObjectiveQuantity::AttitudeTurned}};
  problem.objective[0].after = 2;
  problem.post_impact.controllers = {"joint_damping"};
  problem.post_impact.residual_base_rate_max = 1;
  problem.post_impact.attitude_change_max = 1;
  problem.approach.enabled = false;
  problem.search.starts = 4;
  return problem;
}

double reference_value(const CaptureProblem& problem, const Configuration& at) {
  const auto response = verification::posture_response(problem, at.phi);
  const auto motion = verification::target_motion(
      problem, at, at.base * Vector3d(response.dynamics.hand_position), at.contact_time);
  const auto event = verification::contact_event(problem, motion ? &*motion : nullptr, at);
  return verification::objective_value(
      problem, response, verification::impulse_along(problem, event, response, event.n));
}

void check_claims(const Verification& verdict) {
  for (const Claim& claim : verdict.claims) {
    INFO(claim.name << ": " << claim.detail);
    CHECK_FALSE(claim.fails());
  }
}

bool passes(const Plan& plan, const std::string& name) {
  for (const Claim& claim : judge_plan(plan).claims) {
    if (claim.name == name) return claim.pass;
  }
  throw std::logic_error("no claim " + name);
}

}  // namespace

TEST_CASE("a plan with little attitude change after the impact is verified, misstated it is not") {
  const CaptureProblem problem = turning_problem();
  const Plan plan = make_plan(problem);
  REQUIRE(plan.status == PlanStatus::Optimal);
  CHECK(plan.objective.name == "attitude_turned");
  CHECK(plan.objective.unit == "rad");
  CHECK(plan.objective.terms.at("attitude_turned") == plan.objective.nominal);
  CHECK(plan.objective.worst_case == plan.objective.nominal);
  CHECK(plan.nominal_optimum->worst_case == plan.nominal_optimum->nominal);
  CHECK_FALSE(plan.certificate.reduced_hessian_min_eigenvalue);
  CHECK(reference_value(problem, plan.configuration) < 1e-9);  // elsewhere it is 1e-3 to 1e-1
  check_claims(judge_plan(plan));

  Plan misstated = plan;
  misstated.objective.nominal += 1e-6;
  CHECK_FALSE(passes(misstated, "objective_nominal"));
  misstated = plan;
  misstated.objective.worst_case += 1e-6;
  CHECK_FALSE(passes(misstated, "objective_worst_case"));
  misstated = plan;
  misstated.objective.terms.at("attitude_turned") += 1e-6;
  CHECK_FALSE(passes(misstated, "objective_terms"));
  misstated = plan;
  misstated.candidates.back().objective += 1e-6;
  CHECK_FALSE(passes(misstated, "candidates_objective"));
  misstated = plan;
  misstated.candidates.back().worst_case += 1e-6;
  CHECK_FALSE(passes(misstated, "candidates_worst_case"));
  // Two seconds are not three.
  misstated = plan;
  misstated.problem.objective[0].after = 3;
  CHECK_FALSE(judge_plan(misstated).pass);
}

TEST_CASE("no posture has less attitude change and joint rates than the best candidate of a plan") {
  CaptureProblem problem = turning_problem();
  problem.objective[0].size = 0.02;
  problem.objective.push_back({ObjectiveQuantity::JointRateNorm, 0.5});
  problem.search.starts = 12;
  const Plan plan = make_plan(problem);
  REQUIRE(plan.certificate.kkt_residual <= 1e-6);
  CHECK(plan.objective.terms.size() == 2);
  CHECK(reference_value(problem, plan.configuration) == Approx(plan.objective.value).epsilon(1e-6));
  check_claims(judge_plan(plan));
  // The plan keeps clear of collisions, the best candidate need not.
  const Candidate& best = plan.candidates.front();
  const double planned = reference_value(problem, best.configuration);
  CHECK(planned == Approx(best.objective).epsilon(1e-6));
  CHECK(planned > 0.01);
  double least = kInfinity;
  Random random(401);
  for (int i = 0; i < 400; ++i) {
    Configuration at = best.configuration;
    // Half of them anywhere, half of them near by.
    for (double& angle : at.phi) {
      angle = i % 2 == 0 ? random.uniform(-M_PI, M_PI) : angle + random.uniform(-0.1, 0.1);
    }
    least = std::min(least, reference_value(problem, at));
  }
  INFO("planned " << planned << ", least of random ones " << least);
  CHECK(planned <= least * (1 + 1e-6));
}

TEST_CASE("the mean attitude change over uncertain encounters is minimised and verified") {
  CaptureProblem problem = turning_problem();
  problem.objective[0].after = 0.5;
  problem.measure.kind = RiskMeasure::Expectation;
  problem.measure.samples = 3;
  problem.uncertainty.restitution = 0.2;
  problem.uncertainty.joint_position = JointVectord::Constant(2, 0.02);
  problem.impulse.restitution = 0.5;
  problem.search.starts = 1;
  problem.search.max_candidates = 4;
  const Plan plan = make_plan(problem);
  REQUIRE(plan.nominal_optimum);
  CHECK(plan.objective.value <= plan.nominal_optimum->value * (1 + 1e-9));
  CHECK(plan.objective.value > plan.objective.nominal);
  check_claims(judge_plan(plan));
}

TEST_CASE("a plan that a limit cut short says what was not judged, and no more") {
  CaptureProblem problem = turning_problem();
  problem.objective.push_back({ObjectiveQuantity::JointRateNorm, 20});
  problem.uncertainty.cone_half_angle = 0.2;
  problem.uncertainty.cone_plane_normal = Vector3d::UnitZ();
  problem.measure.kind = RiskMeasure::WorstCase;
  std::atomic<bool> flag = false;
  PlannerOptions options;
  options.stop.interrupted = &flag;
  options.on_progress = [&flag](const std::string& what, int done, int) {
    if (what == "search" && done == 2) flag = true;
  };
  const Plan plan = make_plan(problem, options);
  CHECK(plan.status == PlanStatus::Limit);
  CHECK_FALSE(plan.objective.is_judged);
  CHECK_FALSE(plan.nominal_optimum);
  CHECK_FALSE(std::isfinite(plan.certificate.kkt_residual));
  CHECK(plan.objective.worst_case >= plan.objective.nominal);
  // Nobody had the time to look for a candidate that touches nothing.
  for (const Claim& claim : judge_plan(plan).claims) {
    INFO(claim.name << ": " << claim.detail);
    if (claim.name != "contact_collision") CHECK_FALSE(claim.fails());
  }
  const std::string text = plan_to_json(plan, {});
  CHECK(plan_to_json(read_plan(text, "plan.json").plan, {}) == text);

  Plan misstated = plan;
  misstated.status = PlanStatus::Feasible;
  CHECK_FALSE(passes(misstated, "search_record"));
  misstated = plan;
  misstated.objective.is_judged = misstated.candidates[0].is_judged = true;
  CHECK_FALSE(passes(misstated, "worst_case_sampled"));
  CHECK_FALSE(passes(misstated, "candidates_worst_case"));
  misstated = plan;
  misstated.candidates[0].worst_case *= 1000;
  CHECK_FALSE(passes(misstated, "candidates_worst_case"));
  misstated = plan;
  misstated.objective.worst_case *= 0.9;
  CHECK_FALSE(passes(misstated, "worst_case_sampled"));
  misstated = plan;
  misstated.candidates[0].value *= 1.01;
  CHECK_FALSE(passes(misstated, "candidates_value"));
}

TEST_CASE("a plan with a simulated objective is written and read back with its time") {
  const Plan plan = make_plan(turning_problem());
  const std::string text = plan_to_json(plan, {});
  const PlanFile again = read_plan(text, "plan.json");
  CHECK(again.plan.problem.objective[0].after == 2);
  CHECK(plan_to_json(again.plan, {}) == text);
  CHECK(judge_plan(again.plan).pass);
}

}  // namespace stillbase
