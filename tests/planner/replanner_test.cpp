// A plan kept up to date while the estimate of its target moves.
#include <catch2/catch.hpp>

#include <cmath>

#include <stillbase/core/error.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/io/estimate_file.hpp>
#include <stillbase/nlp/optimizer.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/planner/post_impact.hpp>
#include <stillbase/planner/replanner.hpp>
#include <stillbase/verification/verification.hpp>

#include "formulation/measures/measure.hpp"
#include "support/count_allocations.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// From few starts, without path, proof and motion afterwards.
Plan posture_plan(const std::string& name) {
  CaptureProblem problem = test::without_path(name);
  problem.search.starts = 16;
  PlannerOptions options;
  options.prover = nullptr;
  return make_plan(problem, options);
}

const Plan& client_plan() {
  static const Plan plan = posture_plan("iiwa_client_50");
  return plan;
}

std::vector<StateEstimate> client_stream() {
  return read_estimates(STILLBASE_SOURCE_DIR "/problems/streams/iiwa_client_50.csv");
}

StateEstimate disturbed(const TargetState& state, Random& random, double size) {
  StateEstimate out{state};
  out.state.pose.position += 0.02 * size * random.unit_vector();
  out.state.pose.orientation =
      (state.pose.orientation * rotation_exp(0.02 * size * random.unit_vector())).normalized();
  out.state.linear_velocity += 2e-4 * size * random.unit_vector();
  out.state.angular_velocity += 2e-4 * size * random.unit_vector();
  return out;
}

/// The plan with what was replanned in place of its own.
Plan replanned(const Plan& plan, const Replanner& replanner) {
  const ReplanResult& result = replanner.last();
  Plan out;
  out.problem = plan.problem;
  out.problem.target_state = replanner.problem().target_state;
  out.status = PlanStatus::Optimal;
  out.optimizer = plan.optimizer;
  out.configuration = result.configuration;
  out.impact = impact_at(out.problem, result.configuration);
  const Formulation formulation(out.problem);
  out.objective = plan.objective;
  out.objective.nominal = result.nominal;
  out.objective.worst_case = result.worst_case;
  out.objective.worst_direction = result.worst_direction;
  out.objective.value = result.value;
  out.objective.terms = objective_terms(out.problem, formulation, result.configuration);
  out.constraints = result.constraints;
  out.certificate.max_violation = result.max_violation;
  Candidate candidate;
  candidate.configuration = result.configuration;
  candidate.objective = result.nominal;
  candidate.worst_case = result.worst_case;
  candidate.value = result.value;
  candidate.collision_free = true;
  out.candidates.push_back(candidate);
  return out;
}

/// Names of the checks that fail, by code that shares nothing with the replanner.
std::string failed_checks(const Plan& plan) {
  VerifyOptions options;
  options.post_impact = false;
  options.cone_samples = 400;
  options.prover = nullptr;
  std::string out;
  for (const Claim& claim : verify_plan(plan, options).claims) {
    if (claim.fails()) out += claim.name + ": " + claim.detail + "\n";
  }
  return out;
}

bool is_feasible(const ReplanResult& result) {
  return result.status == ReplanStatus::Optimal || result.status == ReplanStatus::Feasible;
}

}  // namespace

TEST_CASE("a replanner begins with the plan's own posture") {
  const Plan& plan = client_plan();
  const Replanner replanner(plan);
  const ReplanResult& first = replanner.last();
  CHECK(first.status == ReplanStatus::Optimal);
  CHECK(first.value == Approx(plan.objective.value).epsilon(1e-9));
  CHECK(first.nominal == Approx(plan.objective.nominal).epsilon(1e-6));
  CHECK((first.configuration.phi - plan.configuration.phi).norm() < 1e-5);
  REQUIRE(first.constraints.size() == plan.constraints.size());
  for (std::size_t i = 0; i < first.constraints.size(); ++i) {
    CHECK(first.constraints[i].name == plan.constraints[i].name);
  }
}

TEST_CASE("every update of the shipped stream is feasible and never worse than the old posture") {
  const Plan& plan = client_plan();
  Replanner replanner(plan);
  int number = 0;
  for (const StateEstimate& estimate : client_stream()) {
    INFO("at " << estimate.state.time << " s");
    const ReplanResult& result = replanner.replan(estimate);
    REQUIRE(is_feasible(result));
    CHECK_FALSE(result.was_cut);
    CHECK(result.max_violation <= kFeasibilityTolerance);
    CHECK(result.value <= result.corrected.value * (1 + 1e-12));
    if (result.old.is_feasible()) CHECK(result.value <= result.old.value * (1 + 1e-12));
    CHECK(result.contact.has_value());
    if (number++ % 25 == 0) CHECK(failed_checks(replanned(plan, replanner)) == "");
  }
  CHECK(number == 226);
}

TEST_CASE("the last posture of the shipped stream is a local minimum of a fresh search") {
  const Plan& plan = client_plan();
  Replanner replanner(plan);
  for (const StateEstimate& estimate : client_stream()) replanner.replan(estimate);
  const ReplanResult& last = replanner.last();
  CaptureProblem problem = plan.problem;
  problem.target_state = replanner.problem().target_state;
  const Formulation formulation(problem);
  Measure measure(problem, formulation);
  const Eigen::VectorXd x = formulation.variables(last.configuration);
  CHECK(measure.certify(x).kkt_residual <= 1e-6);
  CHECK(measure.reported(x) == Approx(last.value).epsilon(1e-9));
  const auto optimizer = nlp::make_optimizer("sqp");
  const MeasureSolution found = measure.finish(*optimizer, {}, x);
  CHECK(last.value <= measure.reported(found.x) * (1 + 1e-6));
}

TEST_CASE("an update does not allocate") {
  if (!kCountsAllocations) {
    WARN("allocations are not counted in this build");
    return;
  }
  for (const char* name : {"iiwa_client_50", "iiwa_mean", "deos_client_224", "ets7_client"}) {
    CaptureProblem problem = test::without_path(name);
    problem.search.starts = 4;
    PlannerOptions options;
    options.prover = nullptr;
    const Plan plan = make_plan(problem, options);
    Replanner replanner(plan);
    Random random(8);
    int changed = 0;
    for (int i = 0; i < 12; ++i) {
      StateEstimate estimate = disturbed(problem.target_state, random, i % 4 == 3 ? 20 : 1);
      if (i % 2 == 1) estimate.covariance = 1e-8 * StateCovariance::Identity();
      if (i == 10) estimate.state.pose.position.x() = std::nan("");
      const double before = replanner.last().value;
      const long count = allocation_count;
      const ReplanResult& result = replanner.replan(estimate);
      const long allocations = allocation_count - count;
      INFO(name << ", update " << i);
      CHECK(allocations == 0);
      if (result.value != before) ++changed;
    }
    CHECK(changed > 5);
  }
}

TEST_CASE("the KKT residual that an update states is that of the search's certificate") {
  const Plan& plan = client_plan();
  Replanner replanner(plan);
  Random random(4);
  for (int i = 0; i < 10; ++i) {
    const ReplanResult& result = replanner.replan(disturbed(plan.problem.target_state, random, 1));
    REQUIRE(result.status == ReplanStatus::Optimal);
    CaptureProblem problem = plan.problem;
    problem.target_state = replanner.problem().target_state;
    const Formulation formulation(problem);
    Measure measure(problem, formulation);
    CHECK(measure.certify(formulation.variables(result.configuration)).kkt_residual <= 1e-6);
  }
}

TEST_CASE("an update whose deadline has passed gives the old posture on the constraints") {
  const Plan& plan = client_plan();
  Replanner replanner(plan);
  Random random(9);
  const StateEstimate estimate = disturbed(plan.problem.target_state, random, 1);
  StopCondition stop;
  stop.deadline = StopCondition::Clock::now();
  const ReplanResult& cut = replanner.replan(estimate, stop);
  CHECK(cut.was_cut);
  CHECK(cut.status == ReplanStatus::Feasible);
  CHECK(cut.steps == 0);
  CHECK(cut.value == cut.corrected.value);
  CHECK(std::isinf(cut.kkt_residual));
  CHECK(failed_checks(replanned(plan, replanner)) == "");
  const double value = cut.value;
  CHECK(replanner.replan(estimate).value < value);
}

TEST_CASE("the same calls give the same bytes") {
  const Plan& plan = client_plan();
  Replanner first(plan), second(plan);
  Random random(10);
  for (int i = 0; i < 5; ++i) {
    const StateEstimate estimate = disturbed(plan.problem.target_state, random, 2);
    const ReplanResult &a = first.replan(estimate), &b = second.replan(estimate);
    CHECK(a.value == b.value);
    CHECK(a.configuration.phi == b.configuration.phi);
    CHECK(a.steps == b.steps);
  }
}

TEST_CASE("an estimate that cannot be used is refused and changes nothing") {
  const Plan& plan = client_plan();
  Replanner replanner(plan);
  const TargetState good = plan.problem.target_state;
  const JointVectord phi = replanner.last().configuration.phi;
  const auto refusal = [&](const TargetState& state) {
    const ReplanResult& result = replanner.replan({state});
    CHECK(result.status == ReplanStatus::Refused);
    CHECK(result.configuration.phi == phi);
    CHECK(replanner.problem().target_state.time == good.time);
    return std::string(result.reason);
  };
  TargetState state = good;
  state.angular_velocity.y() = std::nan("");
  CHECK(refusal(state) == "a number is not finite");
  state = good;
  state.pose.orientation.coeffs() *= 1.1;
  CHECK(refusal(state) == "the orientation is no unit quaternion");
  state = good;
  state.time = plan.problem.variables.contact_time_upper + 1;
  CHECK(refusal(state) == "it leaves no time before the end of the window of contact times");
  state = good;
  state.angular_velocity *= 100;
  CHECK(refusal(state) == "the target rotates by more than most_rotation until the contact");
  CHECK(replanner.replan({good}).status == ReplanStatus::Optimal);
}

TEST_CASE("a target that is out of reach is said to be, and the old posture stays") {
  const Plan& plan = client_plan();
  Replanner replanner(plan);
  TargetState away = plan.problem.target_state;
  away.linear_velocity = -away.linear_velocity;  // it leaves
  const ReplanResult& result = replanner.replan({away});
  CHECK(result.status == ReplanStatus::Infeasible);
  CHECK(result.max_violation > 1e-3);
  // A refused estimate states the posture that is held, not that one.
  StateEstimate unusable{plan.problem.target_state};
  unusable.state.time = kInfinity;
  const ReplanResult& refused = replanner.replan(unusable);
  CHECK(refused.status == ReplanStatus::Refused);
  CHECK(refused.max_violation <= kFeasibilityTolerance);
  CHECK((refused.configuration.phi - plan.configuration.phi).norm() < 1e-3);
  const ReplanResult& back = replanner.replan({plan.problem.target_state});
  CHECK(back.status == ReplanStatus::Optimal);
  CHECK(back.value == Approx(plan.objective.value).epsilon(1e-6));
}

TEST_CASE("near the plan's posture the limits after the impact hold that it was chosen for") {
  CaptureProblem problem = test::shipped("iiwa_client_50");
  problem.approach.enabled = false;
  PlannerOptions options;
  options.prover = nullptr;
  const Plan plan = make_plan(problem, options);
  REQUIRE(plan.choice.better > 0);  // candidates that exceed these limits
  ReplanOptions everywhere;
  everywhere.stay_within = kInfinity;
  Replanner near(plan), anywhere(plan, everywhere);
  for (const StateEstimate& estimate : client_stream()) {
    const ReplanResult& result = near.replan(estimate);
    REQUIRE(is_feasible(result));
    const JointVectord moved = result.configuration.phi - plan.configuration.phi;
    CHECK(moved.lpNorm<Eigen::Infinity>() <= ReplanOptions{}.stay_within * (1 + 1e-12));
    anywhere.replan(estimate);
  }
  const Configuration& last = near.last().configuration;
  CHECK(post_impact_failure(near.problem(), last, impact_at(near.problem(), last), {}) == "");
  // The lower measure that the planner had excluded.
  CHECK(anywhere.last().value < near.last().value);
  const Configuration& lower = anywhere.last().configuration;
  CHECK(post_impact_failure(near.problem(), lower, impact_at(near.problem(), lower), {}) != "");
}

TEST_CASE("where nothing is feasible near the plan's posture, farther ones are taken") {
  const Plan& plan = client_plan();
  ReplanOptions options;
  options.stay_within = 1e-4;  // the normal turns by more
  Replanner replanner(plan, options);
  const StateEstimate first = client_stream().front();
  const ReplanResult& result = replanner.replan(first);
  CHECK(is_feasible(result));
  CHECK((result.configuration.phi - plan.configuration.phi).lpNorm<Eigen::Infinity>() > 1e-4);
  // Nor is a feasible old posture lost where there is no time to look farther.
  StopCondition stop;
  stop.deadline = StopCondition::Clock::now();
  const double value = result.value;
  const ReplanResult& again = replanner.replan(first, stop);
  CHECK(again.was_cut);
  CHECK(again.status == ReplanStatus::Feasible);
  CHECK(again.value <= value * (1 + 1e-12));
}

TEST_CASE("a posture that an estimate leaves as it is stays optimal") {
  Replanner replanner(client_plan());
  for (const StateEstimate& estimate : client_stream()) {
    REQUIRE(replanner.replan(estimate).status == ReplanStatus::Optimal);
    const double value = replanner.last().value;
    for (int time = 0; time < 3; ++time) {
      const ReplanResult& again = replanner.replan(estimate);
      CHECK(again.status == ReplanStatus::Optimal);
      CHECK(again.value <= value);
    }
  }
}

TEST_CASE("no contact is planned before the estimate and the lead") {
  const Plan& plan = client_plan();
  ReplanOptions options;
  options.least_lead = 2;
  Replanner replanner(plan, options);
  const TargetMotion motion(*plan.problem.target, plan.problem.target_state, 80);
  const ReplanResult& result = replanner.replan({motion.state(72)});
  CHECK(is_feasible(result));
  CHECK(result.configuration.contact_time >= 74);
}

TEST_CASE("a cone that follows from a covariance follows that of the estimate") {
  const Plan plan = posture_plan("ets7_client");
  REQUIRE(plan.problem.uncertainty.cone_confidence);
  Replanner replanner(plan);
  StateEstimate estimate{plan.problem.target_state};
  const double stated = plan.problem.uncertainty.cone_half_angle;
  CHECK(replanner.replan(estimate).cone_half_angle == stated);
  const EstimateCovariance all = covariance_of(*plan.problem.target_deviations);
  // That of the plan gives the plan's, errors of mass and moments included.
  REQUIRE(plan.problem.target_deviations->moments.maxCoeff() > 0);
  estimate.covariance = all.topLeftCorner<12, 12>();
  CHECK(replanner.replan(estimate).cone_half_angle == Approx(stated).epsilon(1e-3));
  estimate.covariance = all.topLeftCorner<12, 12>() / 4;
  const double wide = replanner.last().worst_case;
  const ReplanResult& narrow = replanner.replan(estimate);
  CHECK(narrow.cone_half_angle < 0.6 * stated);
  CHECK(narrow.cone_half_angle > 0.4 * stated);
  CHECK(narrow.worst_case < wide);
  // What says next to nothing of the direction leaves no cone, and not the one before.
  for (const double factor : {16.0, 400.0}) {
    estimate.covariance = all.topLeftCorner<12, 12>() * (factor * factor);
    CHECK(replanner.replan(estimate).status == ReplanStatus::Refused);
    CHECK_THAT(replanner.last().reason, Catch::Contains("its covariance"));
  }
}

TEST_CASE("problems that a replanner does not cover are refused with the reason") {
  const auto refusal = [](Plan plan) -> std::string {
    try {
      const Replanner replanner(plan);
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  };
  const auto plan_of = [](const std::string& name) {
    Plan plan;
    plan.problem = test::shipped(name);
    plan.configuration = start_configuration(plan.problem);
    return plan;
  };
  CHECK_THAT(refusal(plan_of("planar_two_link_c2_a")), Catch::Contains("impact.direction"));
  CHECK_THAT(refusal(plan_of("planar_three_link_cvar")), Catch::Contains("cvar"));
  Plan simulated = plan_of("iiwa_client_50");
  simulated.problem.objective.front().quantity = ObjectiveQuantity::AttitudeTurned;
  CHECK_THAT(refusal(simulated), Catch::Contains("simulated"));
  Plan mean = plan_of("ets7_client");
  mean.problem.measure.kind = RiskMeasure::Expectation;
  CHECK_THAT(refusal(mean), Catch::Contains("expectation"));
  CHECK_THAT(refusal(plan_of("deos_latch_residual")), Catch::Contains("residual_velocity"));
  Plan empty = plan_of("iiwa_client_50");
  empty.configuration = {};
  CHECK_THAT(refusal(empty), Catch::Contains("no-configuration: configuration: "));
}

}  // namespace stillbase
