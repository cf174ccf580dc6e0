#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/audit/audit.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

using test::shipped;

/// Everything of a plan that must not change from run to run.
std::string fingerprint(Plan plan) {
  plan.timing.clear();
  return plan_to_json(plan, {});
}

}  // namespace

TEST_CASE(
    "the C2 problem of reading A lists its eight postures and chooses one free of collision") {
  const Plan plan = make_plan(shipped("planar_two_link_c2_a"));
  REQUIRE(plan.candidates.size() == 8);
  CHECK(plan.certificate.distinct_solutions == 8);
  int colliding = 0;
  for (const Candidate& candidate : plan.candidates) {
    CHECK(candidate.max_violation < 1e-9);
    colliding += !candidate.collision_free;
    const bool chosen = (candidate.configuration.phi - plan.configuration.phi).norm() == 0;
    if (chosen) CHECK(candidate.collision_free);
  }
  CHECK(colliding == 5);
  CHECK(plan.status == PlanStatus::Optimal);
  CHECK(plan.impact.judgement.impact_case == ImpactCase::C2);
  CHECK(plan.approach.status == ApproachStatus::Found);
}

TEST_CASE("a planner without a prover says that nothing was proven") {
  CaptureProblem problem = shipped("planar_two_link_c2_a");
  problem.approach.enabled = false;
  PlannerOptions options;
  options.prover = nullptr;
  const Plan plan = make_plan(problem, options);
  const Proof& proof = plan.certificate.proof;
  CHECK(plan.candidates.size() == 8);
  CHECK(proof.statement ==
        "no proof: nothing was proven, the program has no prover (stillbase::proof); "
        "the best one is zero, no less is possible");
  CHECK(proof.status == ProofStatus::NotApplicable);
  CHECK(proof.boxes == 0);
  CHECK_FALSE(proof.lower_bound.has_value());
}

TEST_CASE("what the search missed is found by the proof and becomes a candidate", "[proofs]") {
  CaptureProblem problem = shipped("planar_two_link_c2_a");
  problem.search.starts = 1;
  problem.approach.enabled = false;
  problem.post_impact.controllers.clear();
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  INFO(proof.statement);
  CHECK(proof.status == ProofStatus::Complete);
  REQUIRE(proof.found_by_search < 8);
  REQUIRE(plan.candidates.size() == 8);
  CHECK(proof.statement.find("missed by the search and added") != std::string::npos);
  for (std::size_t s = 0; s < proof.solutions.size(); ++s) {
    REQUIRE(proof.candidates[s] >= 0);
    const Candidate& candidate = plan.candidates[static_cast<std::size_t>(proof.candidates[s])];
    const JointVectord middle = (proof.solutions[s].lower + proof.solutions[s].upper) / 2;
    CHECK((candidate.configuration.phi - middle).norm() < 1e-10);
  }
}

TEST_CASE("a search with what the proof adds does not lose what it had found", "[proofs]") {
  CaptureProblem problem = shipped("planar_three_link_null");
  problem.search.starts = 1;
  problem.search.seed = 1;
  problem.approach.enabled = false;
  problem.post_impact.controllers.clear();
  const Proof proof = make_plan(problem).certificate.proof;
  INFO(proof.statement);
  REQUIRE(proof.found_by_search < static_cast<int>(proof.solutions.size()));
  for (const int candidate : proof.candidates) CHECK(candidate >= 0);
}

TEST_CASE("with enough starts the proof says that none was missed, and the gap of a null",
          "[proofs]") {
  const Plan isolated = make_plan(shipped("planar_two_link_c2_b"));
  CHECK(isolated.certificate.proof.statement ==
        "proven complete: 10 solutions enclosed, none missed");
  CaptureProblem nominal = shipped("planar_three_link_null");
  nominal.measure.kind = RiskMeasure::Nominal;
  const Plan null = make_plan(nominal);
  const Proof& proof = null.certificate.proof;
  INFO(proof.statement);
  CHECK(proof.status == ProofStatus::Complete);
  CHECK(proof.lower_bound == 0.0);
  CHECK(proof.gap.value() < 1e-12);
  CHECK(proof.statement.find("none missed") != std::string::npos);
  CHECK(null.certificate.reduced_hessian_min_eigenvalue.value() > 0);
}

TEST_CASE("a case that joint limits exclude is proven not to exist", "[proofs]") {
  CaptureProblem problem = shipped("planar_two_link_c2_a");
  for (Joint& joint : problem.robot.joints) {
    joint.type = JointType::Revolute;
    joint.lower = 0.5;
    joint.upper = 0.6;
  }
  problem.start = JointVectord::Constant(2, 0.55);
  problem.search.starts = 4;
  const Plan plan = make_plan(problem);
  CHECK(plan.status == PlanStatus::Infeasible);
  CHECK(plan.certificate.proof.status == ProofStatus::Complete);
  CHECK(plan.certificate.proof.statement == "proven: there is no solution within the joint limits");
}

TEST_CASE("a capture with a seven-joint arm is planned with its approach on a floating base") {
  const CaptureProblem problem = shipped("iiwa_client_50");
  const Plan plan = make_plan(problem);
  // The better candidates run into a stop of joint_2 within the horizon.
  CHECK(plan.status == PlanStatus::Feasible);
  CHECK(plan.certificate.kkt_residual <= 1e-6);
  CHECK(plan.choice.better > 0);
  CHECK(plan.candidates.front().excluded == "after the impact: joint_2 reaches its stop");
  REQUIRE(plan.after_horizon);
  CHECK(plan.after_horizon->moves);
  CHECK(plan.after_horizon->stop_time.value_or(0) > problem.post_impact.horizon);
  REQUIRE(plan.approach.status == ApproachStatus::Found);
  CHECK(plan.approach.min_clearance >= problem.approach.clearance);
  CHECK(plan.approach.attitude_excursion > 0.01);
  CHECK(plan.approach.times.back() == Approx(plan.configuration.contact_time).epsilon(1e-12));
  CHECK(plan.impact.closing_speed >= problem.constraints.closing_speed_min);
  CHECK(plan.objective.worst_case >= plan.objective.nominal);
  SECTION("every solver that was used is counted") {
    CHECK(plan.solver_calls.at("sqp") >= problem.search.starts);
    CHECK(plan.solver_calls.at("rrt_connect") >= 1);
  }
  SECTION("the straight joint-space line collides, so the path has a way point between") {
    // A straight path changes all joints in proportion; ours does not.
    const auto& path = plan.approach.joint_positions;
    const JointVectord whole = path.back() - path.front();
    double off_line = 0;
    for (const JointVectord& phi : path) {
      const JointVectord part = phi - path.front();
      const double along = part.dot(whole) / whole.squaredNorm();
      off_line = std::max(off_line, (part - along * whole).norm());
    }
    CHECK(off_line > 0.05);
  }
}

TEST_CASE(
    "a base with a stated start rotates under the arm and the hand still reaches the contact") {
  const CaptureProblem problem = shipped("iiwa_fixed_start");
  const Plan plan = make_plan(problem);
  INFO(plan.approach.detail);
  REQUIRE(plan.approach.status == ApproachStatus::Found);
  CHECK(plan.approach.base_poses.front().position == problem.base.position);
  CHECK(plan.approach.attitude_excursion > 0.2);
  CHECK(plan.configuration.phi == plan.approach.joint_positions.back());
  CHECK(rotation_log(problem.base.orientation.conjugate() * plan.configuration.base.orientation)
            .norm() > 0.2);
  CHECK(plan.approach.hand_position_error < 1e-8);
  CHECK(plan.approach.hand_angle_error < 1e-8);
  CHECK(plan.certificate.max_violation < 1e-9);
  VerifyOptions options;
  options.post_impact = false;
  for (const Claim& claim : judge_plan(plan, options).claims) {
    INFO(claim.name << ": " << claim.detail);
    CHECK_FALSE(claim.fails());
  }
}

TEST_CASE("Ipopt plans the same capture") {
  CaptureProblem problem = shipped("iiwa_client_50");
  problem.measure.kind = RiskMeasure::Nominal;  // robustly it takes ten times as long
  problem.search.optimizer = "ipopt";
  problem.search.starts = 8;
  const Plan plan = make_plan(problem);
  CHECK(plan.certificate.kkt_residual <= 1e-6);
  CHECK((plan.status == PlanStatus::Optimal) == (plan.choice.loss_percent == 0.0));
  CHECK(plan.solver_calls.at("ipopt") >= 8);
  CHECK(plan.approach.status == ApproachStatus::Found);
}

TEST_CASE("the same seed gives the same plan to the last byte, another seed another path") {
  CaptureProblem problem = shipped("iiwa_client_50");
  problem.search.starts = 16;
  const std::string first = fingerprint(make_plan(problem));
  CHECK(fingerprint(make_plan(problem)) == first);
  problem.search.seed = 2;
  CHECK(fingerprint(make_plan(problem)) != first);
}

TEST_CASE("an obstacle on the path changes the path") {
  CaptureProblem problem = shipped("iiwa_client_50");
  problem.search.starts = 16;
  const Plan free = make_plan(problem);
  REQUIRE(free.approach.status == ApproachStatus::Found);
  // A ball where the hand passes half-way, fixed to the base.
  const std::size_t middle = free.approach.times.size() / 3;
  const auto kinematics =
      compute_kinematics<double>(problem.robot, free.approach.joint_positions[middle]);
  Obstacle ball;
  ball.name = "ball";
  ball.frame = Frame::Base;
  ball.pose.position = kinematics.r_bh;
  ball.geometry = Sphere{0.04};
  problem.obstacles.push_back(ball);
  const Plan around = make_plan(problem);
  REQUIRE(around.approach.status == ApproachStatus::Found);
  double nearest = 1e9;
  for (const JointVectord& phi : around.approach.joint_positions) {
    nearest = std::min(
        nearest, (compute_kinematics<double>(problem.robot, phi).r_bh - ball.pose.position).norm());
  }
  CHECK(nearest > 0.04);
}

TEST_CASE("every shipped problem with something to plan is planned, with an approach where asked") {
  for (const char* name : {"iiwa_cone", "planar_three_link_null", "planar_three_link_client",
                           "planar_two_link_c2_b", "spart_3dof_point"}) {
    const CaptureProblem problem = shipped(name);
    const Plan plan = make_plan(problem);
    INFO(name << ": " << to_string(plan.approach.status) << " " << plan.approach.detail);
    CHECK((plan.status == PlanStatus::Optimal || plan.status == PlanStatus::Feasible));
    CHECK(plan.certificate.max_violation <= 1e-9);
    CHECK(plan.approach.status ==
          (problem.approach.enabled ? ApproachStatus::Found : ApproachStatus::NotRequested));
  }
}

TEST_CASE("without an approach asked for, a plan whose candidates all touch something says so") {
  CaptureProblem problem = shipped("planar_three_link_null");
  problem.approach.enabled = false;
  problem.obstacles = {{"wall", Frame::Base, Pose{}, Sphere{20}}};
  const Plan plan = make_plan(problem);
  CHECK(plan.status != PlanStatus::Infeasible);
  CHECK(plan.approach.status == ApproachStatus::GoalInvalid);
  CHECK(plan.approach.detail.find("no candidate is free of collision") == 0);
  problem.obstacles.clear();
  CHECK(make_plan(problem).approach.status == ApproachStatus::NotRequested);
}

TEST_CASE("stopping at once still gives the best point so far, marked") {
  CaptureProblem problem = shipped("iiwa_client_50");
  std::atomic<bool> stop{true};
  PlannerOptions options;
  options.stop.interrupted = &stop;
  const Plan plan = make_plan(problem, options);
  CHECK(plan.status == PlanStatus::Limit);
  CHECK(plan.candidates.size() == 1);
}

TEST_CASE(
    "the closing speed of a target that does not rotate is stated, though nothing changes it") {
  CaptureProblem problem = test::without_path("detumble_client_1000");
  problem.target_state.angular_velocity.setZero();
  problem.search.starts = 4;
  const auto closing_speed = [](const Plan& plan) {
    const auto found =
        std::find_if(plan.constraints.begin(), plan.constraints.end(),
                     [](const ConstraintValue& c) { return c.name == "closing_speed"; });
    REQUIRE(found != plan.constraints.end());
    return *found;
  };
  const Plan plan = make_plan(problem);
  CHECK(plan.status == PlanStatus::Optimal);
  CHECK(closing_speed(plan).value == Approx(0.0144).epsilon(0.01));
  CHECK(failures(plan).empty());
  problem.constraints.closing_speed_min = 0.02;
  const Plan slow = make_plan(problem);
  CHECK(slow.status == PlanStatus::Infeasible);
  CHECK(closing_speed(slow).violation > 0.005);
}

}  // namespace stillbase
