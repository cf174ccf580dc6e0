// Plans whose hand moves with the target at the contact: path, arrival, stop, verification.
#include <catch2/catch.hpp>

#include <algorithm>

#include <stillbase/audit/audit.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/verification/verification.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

std::vector<std::string> failed_names(const Verification& verification) {
  std::vector<std::string> out;
  for (const Claim& claim : verification.claims) {
    if (claim.fails()) out.push_back(claim.name);
  }
  return out;
}

const Claim* find_claim(const Verification& verification, const std::string& name) {
  for (const Claim& claim : verification.claims) {
    if (claim.name == name) return &claim;
  }
  return nullptr;
}

Plan matched_plan(const std::string& name, int starts, std::uint64_t seed = 1,
                  PathPolish polish = PathPolish::None) {
  CaptureProblem problem = test::shipped(name);
  problem.approach.polish = polish;
  problem.search.starts = starts;
  problem.search.seed = seed;
  return make_plan(problem);
}

void check_matched(const Plan& plan, const Verification& verification) {
  INFO(plan.problem.name << ": " << plan.approach.detail);
  REQUIRE(plan.approach.status == ApproachStatus::Found);
  CHECK_THAT(failed_names(verification), Catch::Matchers::Equals(std::vector<std::string>{}));
  for (const char* name :
       {"arrival_match", "approach_arrival_match", "approach_arrival_velocity"}) {
    const Claim* claim = find_claim(verification, name);
    REQUIRE(claim != nullptr);
    CHECK(claim->limit <= 1e-6);
    CHECK(claim->pass);
  }
  REQUIRE(find_claim(verification, "abort_clearance") != nullptr);
  REQUIRE(plan.impact.before);
  CHECK(plan.impact.Fbar.norm() < 1e-6 * plan.impact.before->Fbar_at_rest.norm());
  CHECK((plan.approach.joint_velocities.back() - plan.impact.before->phidot).norm() <= 1e-12);
}

}  // namespace

TEST_CASE("a plan with a matched hand verifies, and one that says other rates does not") {
  const Plan plan = matched_plan("matched_light", 6);
  const Verification verification = verify_plan(plan);
  check_matched(plan, verification);
  REQUIRE(find_claim(verification, "first_instant") != nullptr);
  CHECK(find_claim(verification, "first_instant")->pass);

  VerifyOptions options;
  options.post_impact = false;
  const auto fails = [&](const Plan& changed, const std::string& name) {
    const std::vector<std::string> failed = failed_names(verify_plan(changed, options));
    INFO(name);
    CHECK(std::find(failed.begin(), failed.end(), name) != failed.end());
  };
  Plan changed = plan;
  changed.approach.joint_velocities.back()[2] += 1e-5;
  fails(changed, "approach_arrival_velocity");
  fails(changed, "approach_arrival_match");
  fails(changed, "approach_rest");
  changed = plan;
  changed.impact.before->phidot[1] *= 1 + 1e-6;
  fails(changed, "arrival_joint_rates");
  changed = plan;
  changed.impact.before->relative_velocity[0] += 2e-6;
  fails(changed, "arrival_relative_velocity");
  changed = plan;
  changed.impact.before->hand_velocity[4] += 2e-6;
  fails(changed, "arrival_match");
  changed = plan;
  changed.impact.before->Fbar_at_rest[0] *= 1 + 1e-6;
  fails(changed, "at_rest_impulse");
  changed = plan;
  changed.impact.before.reset();
  fails(changed, "hand_motion");
  changed = plan;
  changed.approach.abort.reset();
  fails(changed, "abort_found");
  changed = plan;
  changed.approach.abort->joint_velocities.front().setZero();
  fails(changed, "abort_start");
  changed = plan;
  changed.approach.abort->joint_velocities.back()[0] = 1e-3;
  fails(changed, "abort_rest");
  changed = plan;
  changed.approach.abort->base_poses.back().position[0] += 1e-6;
  fails(changed, "abort_base_steps");
  changed = plan;
  changed.approach.abort->effort_used *= 1.001;
  fails(changed, "abort_effort_used");
  changed = plan;
  changed.approach.abort->retreat += 1e-3;
  fails(changed, "abort_retreat");
  changed = plan;
  changed.approach.abort->min_clearance += 1e-3;
  fails(changed, "abort_stated_clearance");
  // A stop on the spot lets the target run into the hand.
  changed = plan;
  AbortPath& abort = *changed.approach.abort;
  for (JointVectord& phi : abort.joint_positions) phi = plan.configuration.phi;
  for (JointVectord& phidot : abort.joint_velocities) phidot.setZero();
  for (Pose& pose : abort.base_poses) pose = plan.configuration.base;
  fails(changed, "abort_gap");
}

TEST_CASE("without matching the same posture states the impulse that matching saves") {
  const Plan plan = matched_plan("matched_light", 2);
  CaptureProblem waiting = plan.problem;
  waiting.hand_motion = {};
  const ImpactSummary at_rest = impact_at(waiting, plan.configuration);
  REQUIRE(plan.impact.before);
  CHECK(plan.impact.before->Fbar_at_rest.isApprox(at_rest.Fbar, 1e-12));
  CHECK(plan.impact.before->base_at_rest.isApprox(at_rest.base, 1e-10));
  CHECK_FALSE(at_rest.before);
  // The momentum of the pair is the target's, whatever the hand does.
  CHECK(plan.impact.total.isApprox(at_rest.total, 1e-10));
}

TEST_CASE("what a matched hand makes vanish is compared with what it would be at rest") {
  CaptureProblem problem = test::without_path("matched_light");
  problem.search.starts = 6;
  problem.objective.front().quantity = ObjectiveQuantity::ImpulseMagnitude;
  const Plan plan = make_plan(problem);
  CHECK(plan.objective.nominal < 1e-12);
  const Verification judged = judge_plan(plan, {});
  for (const char* name : {"objective_nominal", "objective_terms", "candidates_objective"}) {
    const Claim* claim = find_claim(judged, name);
    REQUIRE(claim != nullptr);
    CHECK(claim->pass);
  }
}

TEST_CASE("a covariance of zero is a point, also where the hand moves") {
  CaptureProblem problem = test::without_path("matched_residual");
  problem.search.starts = 6;
  problem.uncertainty.residual_velocity->covariance = Matrix6d::Zero();
  const Plan plan = make_plan(problem);
  const std::vector<std::string> failed = failed_names(judge_plan(plan, {}));
  CHECK(std::count(failed.begin(), failed.end(), "worst_velocity") == 0);
}

TEST_CASE(
    "beside a singular posture the optimum of a matched hand is not judged, with the reason") {
  CaptureProblem problem = test::without_path("matched_light");
  problem.constraints.clearance.reset();
  problem.constraints.joint_limit_margin = 0;
  problem.search.starts = 12;
  const double bend = GENERATE(1e-6, 1e-8);
  for (const std::size_t k : {1, 2, 3, 4}) {
    Joint& joint = problem.robot.joints[k];
    joint.lower = -bend;
    joint.upper = bend;
    problem.start[static_cast<Eigen::Index>(k)] = 0;
  }
  INFO("bent by at most " << bend << " rad");
  const Plan plan = make_plan(problem);
  REQUIRE(plan.status == PlanStatus::Optimal);
  const Verification judged = judge_plan(plan, {});
  CHECK_THAT(failed_names(judged), Catch::Matchers::Equals(std::vector<std::string>{}));
  const Claim* claim = find_claim(judged, "kkt_residual");
  REQUIRE(claim != nullptr);
  CHECK_FALSE(claim->is_checked);
  CHECK_THAT(claim->detail, Catch::Contains("constraints.jacobian_singular_value_min"));
}

TEST_CASE("a polished path to a matched hand holds") {
  const PathPolish polish = GENERATE(PathPolish::Time, PathPolish::Attitude);
  Plan plan = matched_plan("matched_light", 6, 1, polish);
  check_matched(plan, judge_plan(plan, {}));
  plan.approach.after_polish *= 0.999;
  CHECK_THAT(failed_names(judge_plan(plan, {})),
             Catch::Matchers::Equals(std::vector<std::string>{"approach_polish_stated"}));
}

TEST_CASE("shipped problems with a matched hand are planned and hold", "[.slow]") {
  const std::string name =
      GENERATE("matched_light", "matched_medium", "matched_heavy", "matched_residual");
  const Plan plan = make_plan(test::shipped(name));
  check_matched(plan, judge_plan(plan, {}));
}

TEST_CASE("a matched hand arrives with twenty seeds of twenty", "[.slow]") {
  const std::string name = GENERATE("matched_light", "matched_medium", "matched_heavy");
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    INFO(name << ", seed " << seed);
    const Plan plan = matched_plan(name, 16, seed);
    check_matched(plan, verify_plan(plan));
  }
}

}  // namespace stillbase
