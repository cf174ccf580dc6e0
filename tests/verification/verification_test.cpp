// Correct plans pass. Plans with one error fail the check that is about it.
#include <catch2/catch.hpp>

#include <limits>

#include <stillbase/audit/audit.hpp>
#include <stillbase/impact/summary.hpp>
#include <stillbase/planner/post_impact.hpp>
#include <stillbase/reference/reference.hpp>

#include "verification/example_plans.hpp"

using namespace stillbase;
using namespace stillbase::verification_test;

namespace {

const Claim* find_claim(const Verification& verification, const std::string& name) {
  for (const Claim& claim : verification.claims) {
    if (claim.name == name) return &claim;
  }
  return nullptr;
}

bool fails(const Verification& verification, const std::string& name) {
  const Claim* claim = find_claim(verification, name);
  return claim != nullptr && !claim->pass && !verification.pass;
}

std::string failures(const Verification& verification) {
  std::string text;
  for (const Claim& claim : verification.claims) {
    if (claim.fails()) text += claim.name + " (" + claim.detail + ") ";
  }
  return text;
}

// Without the simulation, which has tests of its own.
VerifyOptions thorough() {
  VerifyOptions options;
  options.post_impact = false;
  options.cone_samples = 1000;
  return options;
}

// With what a plan says of the time after the impact, of its problem as it is.
Plan accounted(Plan plan) {
  plan.managed_momentum =
      account_after_impact(plan.problem, plan.configuration, plan.impact).momentum;
  const std::vector<std::string>& controllers = plan.problem.post_impact.controllers;
  if (!controllers.empty()) {
    plan.after_horizon =
        motion_after_horizon(plan.problem, plan.configuration, plan.impact, controllers.front());
  }
  return plan;
}

// The smallest clearance is the one number that the small planner does not compute.
Plan with_clearance(Plan plan) {
  const Verification verification = judge_plan(plan, thorough());
  plan.approach.min_clearance = find_claim(verification, "approach_clearance")->value.value();
  return plan;
}

const Plan& floating_plan() {
  static const Plan plan = with_clearance(arm_plan());
  return plan;
}

const Plan& held_plan() {
  static const Plan plan = with_clearance(arm_plan(Flip::None, BaseMode::Held));
  return plan;
}

}  // namespace

TEST_CASE("a correct plan with a floating base passes every check") {
  const Verification verification = judge_plan(accounted(floating_plan()));
  INFO(failures(verification));
  CHECK(verification.pass);
  CHECK(verification.claims.size() > 50);
  for (const Claim& claim : verification.claims) {
    CHECK(claim.value.has_value() == claim.is_checked);
    CHECK_FALSE(claim.name.empty());
    CHECK_FALSE(claim.unit.empty());
    CHECK(std::isfinite(claim.limit));
  }
  REQUIRE(verification.reports.size() == 2);
  for (const ControllerReport& report : verification.reports) {
    CHECK(report.finished);
    CHECK(report.angular_momentum_drift <= 1e-9);
    CHECK(report.linear_momentum_drift <= 1e-9);
    CHECK(report.peak_base_rate > 0);
  }
  // The first controller stops the base, the second one stops the joints.
  CHECK(verification.reports[0].residual_base_rate < 1e-3);
  CHECK(verification.reports[1].residual_joint_rate < 1e-6);
  CHECK(verification.reports[1].residual_base_rate > 1e-3);
}

TEST_CASE("a correct plan with a held base passes") {
  const Verification verification = judge_plan(held_plan(), thorough());
  INFO(failures(verification));
  CHECK(verification.pass);
}

TEST_CASE("a correct plan without an approach passes, and its case is the demanded one") {
  const Verification verification = judge_plan(accounted(straight_plan()));
  INFO(failures(verification));
  CHECK(verification.pass);
  REQUIRE(find_claim(verification, "case_constraint") != nullptr);
  CHECK(find_claim(verification, "approach_found") == nullptr);
  CHECK(verification.reports.empty());
}

TEST_CASE("a plan with numbers of the impact room passes") {
  Plan plan = floating_plan();
  plan.impact =
      summarize_impact(plan.problem.robot, plan.configuration.phi, plan.problem.resistance,
                       plan.impact.Fbar, plan.impact.closing_speed);
  const Verification verification = judge_plan(plan, thorough());
  INFO(failures(verification));
  CHECK(verification.pass);
}

TEST_CASE("a planner with one sign wrong is refused") {
  const std::pair<Flip, const char*> flips[] = {
      {Flip::LinearCoupling, "joint_velocity_jump"},
      {Flip::AngularCoupling, "coupling_angular_momentum"},
      {Flip::LinearAngular, "base_angular_velocity_jump"},
      {Flip::HandLever, "impulse_force"},
      {Flip::HandJacobian, "joint_velocity_jump"},
      {Flip::SystemCentroid, "total_angular_momentum"},
      {Flip::BaseDrift, "approach_momentum"},
      {Flip::ClosingSpeed, "closing_speed"}};
  for (const auto& [flip, claim] : flips) {
    const Verification verification = judge_plan(arm_plan(flip), thorough());
    INFO(claim << ": " << failures(verification));
    CHECK(fails(verification, claim));
  }
  CHECK(fails(judge_plan(arm_plan(Flip::LinearCoupling), thorough()), "approach_momentum"));
  CHECK(fails(judge_plan(arm_plan(Flip::BaseDrift), thorough()), "approach_base_poses"));
}

TEST_CASE("a plan that changes what the problem fixes is refused") {
  struct Wrong {
    const char* claim;
    void (*spoil)(Plan&);
  };
  const Wrong wrongs[] = {
      {"joint_limits", [](Plan& p) { p.problem.robot.joints[3].lower = -0.4; }},
      {"joint_limits", [](Plan& p) { p.problem.constraints.joint_limit_margin = 1.8; }},
      {"fixed_joints", [](Plan& p) { p.problem.variables.joints[2] = false; }},
      {"base_attitude",
       [](Plan& p) {
         p.problem.base.orientation = rotation_exp({0, 0, 1});
       }},
      {"base_position",
       [](Plan& p) {
         p.problem.variables.base_position = PositionFreedom::Box;
         p.problem.variables.base_position_upper = Vector3d(0.3, 1, 1);
         p.problem.variables.base_position_lower = Vector3d(-1, -1, -1);
       }},
      {"contact_time", [](Plan& p) { p.problem.variables.contact_time_upper = 59; }},
      {"hand_position", [](Plan& p) { p.problem.target->features[0].point.y() += 1e-5; }},
      {"hand_axis",
       [](Plan& p) { p.problem.target->features[0].normal = Vector3d(1, 1e-6, 0).normalized(); }},
      {"hand_orientation", [](Plan& p) { p.problem.hand.constraint = HandConstraint::Pose; }},
      {"closing_speed_min", [](Plan& p) { p.problem.constraints.closing_speed_min = 0.06; }},
      {"joint_resistance", [](Plan& p) { p.problem.resistance.rotor_inertia(2) = 0.6; }},
      {"joint_velocity_jump", [](Plan& p) { p.problem.resistance.model = ResistanceModel::Free; }},
      {"impulse_force", [](Plan& p) { p.problem.impulse.restitution = 0.31; }},
      {"impulse_force", [](Plan& p) { p.problem.target->mass = 51; }},
      {"objective_name",
       [](Plan& p) { p.problem.objective = {{ObjectiveQuantity::BaseAngularVelocity}}; }},
      {"objective_nominal",
       [](Plan& p) { p.problem.objective = {{ObjectiveQuantity::TotalAngularMomentum}}; }},
      {"worst_case_sampled", [](Plan& p) { p.problem.uncertainty.cone_half_angle *= 1.01; }},
      {"worst_direction", [](Plan& p) { p.problem.uncertainty.cone_half_angle *= 0.99; }},
      {"case_constraint", [](Plan& p) { p.problem.constraints.impact_case = CaseConstraint::C; }},
      {"impact_case", [](Plan& p) { p.impact.judgement.impact_case = ImpactCase::C2; }},
      {"case_tolerance", [](Plan& p) { p.impact.judgement.tolerance = 1; }},
      {"coupling_rank", [](Plan& p) { p.impact.rank = 2; }},
      {"rank_tolerance", [](Plan& p) { p.impact.rank_tolerance = 0.5; }},
      {"plan_has_solution", [](Plan& p) { p.status = PlanStatus::Infeasible; }},
      {"configuration_is_candidate", [](Plan& p) { p.candidates.clear(); }},
      {"constraint_violation",
       [](Plan& p) {
         p.constraints = {{"other", 2, 0, 1, 1}};
       }},
      {"constraint_stated_violations",
       [](Plan& p) {
         p.constraints = {{"other", 2, 0, 1, 0}};
       }},
      {"constraint_values",
       [](Plan& p) {
         p.constraints = {{"closing_speed", 0.07, 0.001, 1, 0}};
       }},
      {"certificate_violation", [](Plan& p) { p.certificate.max_violation = 1e-3; }},
  };
  for (const Wrong& wrong : wrongs) {
    Plan plan = floating_plan();
    wrong.spoil(plan);
    const Verification verification = judge_plan(plan, thorough());
    INFO(wrong.claim << ": " << failures(verification));
    CHECK(fails(verification, wrong.claim));
  }
}

TEST_CASE("without a cone the worst direction is the normal") {
  Plan plan = floating_plan();
  plan.problem.uncertainty = {};
  const Vector3d n = plan.impact.Fbar.head<3>().normalized();
  const auto is_refused = [&](const Vector3d& d) {
    plan.objective.worst_direction = d;
    return fails(verify_plan(plan, thorough()), "worst_direction");
  };
  CHECK_FALSE(is_refused(n));
  CHECK(is_refused({3, -7, 1e6}));
  CHECK(is_refused((1 + 1e-6) * n));
  CHECK(is_refused((n + 1e-6 * n.unitOrthogonal()).normalized()));
  CHECK(is_refused(Vector3d::Zero()));
}

TEST_CASE("an approach that cannot be flown is refused") {
  struct Wrong {
    const char* claim;
    void (*spoil)(Plan&);
  };
  const Wrong wrongs[] = {
      {"approach_found", [](Plan& p) { p.approach.status = ApproachStatus::TooSlow; }},
      {"approach_start", [](Plan& p) { p.problem.start(1) += 1e-6; }},
      {"approach_arrival", [](Plan& p) { p.approach.joint_positions.back()(0) += 1e-6; }},
      {"approach_contact_time", [](Plan& p) { p.approach.times.back() += 1e-6; }},
      {"approach_rest", [](Plan& p) { p.approach.joint_velocities.front()(0) = 1e-3; }},
      {"approach_wait", [](Plan& p) { p.problem.approach.wait = 5.1; }},
      {"approach_duration", [](Plan& p) { p.problem.approach.max_duration = 24; }},
      {"approach_begins", [](Plan& p) { p.problem.target_state.time = 40; }},
      {"approach_joint_limits", [](Plan& p) { p.problem.robot.joints[4].lower = 0.01; }},
      {"approach_joint_rates", [](Plan& p) { p.problem.robot.joints[1].max_velocity = 0.09; }},
      {"approach_joint_accelerations",
       [](Plan& p) { p.problem.approach.acceleration_limit(1) = 0.007; }},
      {"approach_stated_torques", [](Plan& p) { p.approach.joint_torques[30](2) *= 1.00001; }},
      {"approach_joint_torques", [](Plan& p) { p.problem.robot.joints[0].max_effort = 1e-3; }},
      {"approach_effort_used", [](Plan& p) { p.approach.effort_used *= 1.00001; }},
      {"approach_hand_error", [](Plan& p) { p.approach.hand_angle_error = 1e-6; }},
      {"approach_attitude_kept", [](Plan& p) { p.problem.approach.base = BaseMode::ReactionNull; }},
      {"approach_polish",
       [](Plan& p) {
         p.problem.approach.polish = p.approach.polish = PathPolish::Time;
         p.approach.after_polish = p.approach.duration;
         p.approach.before_polish = p.approach.duration - 1e-3;
       }},
      {"approach_polish_stated",
       [](Plan& p) {
         p.problem.approach.polish = p.approach.polish = PathPolish::Attitude;
         p.approach.before_polish = 9;
       }},
      {"approach_base_start", [](Plan& p) { p.problem.approach.station_free = false; }},
      {"approach_clearance", [](Plan& p) { p.problem.approach.clearance = 1; }},
      {"approach_stated_clearance", [](Plan& p) { p.approach.min_clearance += 0.01; }},
  };
  for (const Wrong& wrong : wrongs) {
    Plan plan = floating_plan();
    wrong.spoil(plan);
    const Verification verification = judge_plan(plan, thorough());
    INFO(wrong.claim << ": " << failures(verification));
    CHECK(fails(verification, wrong.claim));
  }
  // A base that floats is not held, and vice versa.
  Plan plan = floating_plan();
  plan.problem.approach.base = BaseMode::Held;
  CHECK(fails(judge_plan(plan, thorough()), "approach_base_poses"));
  CHECK(fails(judge_plan(plan, thorough()), "approach_base_rates"));
  plan = held_plan();
  plan.problem.approach.base = BaseMode::Floating;
  CHECK(fails(judge_plan(plan, thorough()), "approach_base_poses"));
  CHECK(fails(judge_plan(plan, thorough()), "approach_momentum"));
}

TEST_CASE("a path that no problem asks for is refused") {
  Plan plan = floating_plan();
  REQUIRE_FALSE(plan.problem.hand_motion.moves());
  plan.approach.abort.emplace();
  CHECK(fails(verify_plan(plan, thorough()), "abort_found"));
  plan = floating_plan();
  plan.problem.approach.enabled = false;
  CHECK(fails(verify_plan(plan, thorough()), "approach_found"));
}

TEST_CASE("a body on the approach path and a target that arrives too early are found") {
  // Where the hand is in the middle of the motion, seen from N.
  Plan plan = floating_plan();
  const std::size_t middle = plan.approach.times.size() / 2;
  const auto d =
      reference::compute(plan.problem.robot, {plan.approach.joint_positions[middle], {}, {}});
  Obstacle obstacle;
  obstacle.name = "antenna";
  obstacle.pose.position = plan.approach.base_poses[middle] * Vector3d(d.hand_position);
  obstacle.geometry = Sphere{0.02};
  plan.problem.obstacles = {obstacle};
  const Verification blocked = judge_plan(plan, thorough());
  INFO(failures(blocked));
  CHECK(fails(blocked, "approach_clearance"));
  CHECK(find_claim(blocked, "approach_clearance")->detail.find("antenna") != std::string::npos);

  // A larger client: its body sweeps through the waiting arm.
  plan = floating_plan();
  plan.problem.target->shapes[0].geometry = Box{Vector3d::Constant(1.6)};
  const Verification swept = judge_plan(plan, thorough());
  INFO(failures(swept));
  CHECK(fails(swept, "approach_clearance"));
  CHECK(fails(swept, "contact_collision"));
  CHECK(fails(swept, "candidates_collision_free"));
}

TEST_CASE("the motion after the impact is judged under the first controller alone") {
  Plan plan = floating_plan();
  plan.problem.post_impact.residual_base_rate_max = 1e-3;
  CHECK(judge_plan(accounted(plan)).pass);
  // Joint damping hands the momentum to the base, which keeps turning.
  std::swap(plan.problem.post_impact.controllers[0], plan.problem.post_impact.controllers[1]);
  const Verification damped = judge_plan(plan);
  CHECK(fails(damped, "post_impact_base_rate"));
  plan.problem.post_impact.residual_base_rate_max = 0.1;
  plan.problem.post_impact.attitude_change_max = 0.01;
  CHECK(fails(judge_plan(plan), "post_impact_attitude"));
  plan = floating_plan();
  for (Joint& joint : plan.problem.robot.joints) joint.max_velocity = 0.01;
  CHECK(fails(judge_plan(plan), "post_impact_joint_rates"));
  // The plant gives no more than a joint's limit: what the controller demands is judged.
  plan = floating_plan();
  for (Joint& joint : plan.problem.robot.joints) joint.max_effort = 0.0005;
  const Verification saturated = judge_plan(plan);
  CHECK(fails(saturated, "post_impact_joint_torques"));
  CHECK(find_claim(saturated, "post_impact_joint_torques")->value.value_or(0) > 10);
  plan = floating_plan();
  plan.problem.post_impact.controllers = {"telepathy"};
  const Verification unknown = judge_plan(plan);
  CHECK(fails(unknown, "post_impact_base_rate"));
  CHECK_FALSE(find_claim(unknown, "post_impact_base_rate")->value.has_value());
}

TEST_CASE("a plan that is not complete is refused with the reason, never with a crash") {
  auto spoilt = [](void (*spoil)(Plan&)) {
    Plan plan = floating_plan();
    spoil(plan);
    return judge_plan(plan, thorough());
  };
  const Verification results[] = {
      judge_plan(Plan{}),
      spoilt([](Plan& p) { p.configuration.phi.resize(3); }),
      spoilt([](Plan& p) { p.configuration.phi(2) = std::nan(""); }),
      spoilt([](Plan& p) { p.configuration.base.orientation.w() *= 1.1; }),
      spoilt([](Plan& p) { p.approach.times.pop_back(); }),
      spoilt([](Plan& p) { p.approach.times[4] = p.approach.times[5]; }),
      spoilt([](Plan& p) { p.approach.base_poses[7].position.x() = kInfinity; }),
      spoilt([](Plan& p) { p.approach.joint_velocities[7].resize(2); }),
      spoilt([](Plan& p) { p.candidates[0].configuration.phi.resize(0); })};
  for (const Verification& result : results) CHECK(fails(result, "plan_is_complete"));
  CHECK(fails(spoilt([](Plan& p) { p.problem.target.reset(); }), "contact"));
  CHECK(fails(spoilt([](Plan& p) { p.problem.variables.feature = "minus_x"; }), "contact"));
  CHECK(fails(spoilt([](Plan& p) { p.impact.Delta_phidot.resize(0); }), "joint_velocity_jump"));
  CHECK(fails(spoilt([](Plan& p) { p.objective.worst_direction.setZero(); }),
              "objective_worst_case"));
}

TEST_CASE("a verification that is stopped does not pass") {
  VerifyOptions options;
  options.stop.deadline = StopCondition::Clock::now();
  const Verification verification = judge_plan(floating_plan(), options);
  CHECK_FALSE(verification.pass);
  CHECK(verification.interrupted);
  CHECK(verification.claims.back().detail.find("stopped") != std::string::npos);
  for (const Claim& claim : verification.claims) {
    INFO(claim.name);
    CHECK_FALSE(claim.fails());  // what was not checked did not fail
  }
}
