// Trials: repeatable, and statistics that are what they say.
#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <stillbase/core/random.hpp>
#include <stillbase/encounter/direction_cone.hpp>
#include <stillbase/encounter/residual_velocity.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/verification/trials.hpp>

#include "formulation/measures/measure.hpp"
#include "support/shipped_problem.hpp"

using namespace stillbase;

namespace {

Plan planar_plan(const std::string& name = "planar_two_link_c2_a") {
  return make_plan(test::shipped(name));
}

Perturbations nothing() {
  Perturbations sizes;
  sizes.restitution = sizes.target_mass = sizes.target_inertia = sizes.contact_point = 0;
  sizes.robot_mass = sizes.base_rate_error = sizes.joint_rate_error = 0;
  return sizes;
}

/// Sizes for a problem without those that it does not state.
Perturbations stated_alone(const CaptureProblem& problem) {
  Perturbations sizes = perturbations_for(problem);
  sizes.cone_half_angle = sizes.closing_speed = sizes.contact_time = 0;
  sizes.restitution = sizes.target_mass = sizes.target_inertia = sizes.contact_point = 0;
  sizes.robot_mass = sizes.base_rate_error = sizes.joint_rate_error = 0;
  return sizes;
}

bool same(const TrialOutcome& a, const TrialOutcome& b) {
  return a.inputs == b.inputs && a.objective == b.objective && a.impulse == b.impulse &&
         a.residual_base_rate == b.residual_base_rate && a.success == b.success;
}

/// [v; omega] in B over the trials.
struct SampledVelocity {
  Vector6d mean = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
};

SampledVelocity sampled_velocity(const std::vector<TrialOutcome>& outcomes) {
  SampledVelocity out;
  const auto count = static_cast<double>(outcomes.size());
  for (const TrialOutcome& outcome : outcomes) out.mean += outcome.target_velocity / count;
  for (const TrialOutcome& outcome : outcomes) {
    const Vector6d d = outcome.target_velocity - out.mean;
    out.covariance += d * d.transpose() / (count - 1);
  }
  return out;
}

/// The sample is that of a covariance (in T) and of the nominal velocity, within five standard
/// errors of every eigenvalue and of every component.
void check_sample(const Plan& plan, const SampledVelocity& sample, const Matrix6d& covariance_T,
                  int count) {
  const Configuration& at = plan.configuration;
  const auto motion = encounter_motion(plan.problem, at);
  const Eigen::Quaterniond R_BT =
      at.base.orientation.conjugate() * motion->state(at.contact_time).pose.orientation;
  Matrix6d R = Matrix6d::Zero();
  R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = R_BT.toRotationMatrix();
  const Matrix6d expected = R * covariance_T * R.transpose();
  const Eigen::LLT<Matrix6d> root(expected);
  const auto white = [&root](const Matrix6d& A) -> Matrix6d { return root.matrixL().solve(A); };
  const Matrix6d ratio = white(white(sample.covariance).transpose());
  // 5 sqrt(2 / N) of a variance; the extreme eigenvalues of six lie within 2 sqrt(6 / N) as well.
  const double apart = (5 * std::sqrt(2.0) + 2 * std::sqrt(6.0)) / std::sqrt(count);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(ratio);
  INFO(eigen.eigenvalues().transpose());
  CHECK(eigen.eigenvalues().minCoeff() > 1 - apart);
  CHECK(eigen.eigenvalues().maxCoeff() < 1 + apart);
  const Vector6d nominal = run_trials(plan, nothing(), 1, 0, 1, 1)[0].target_velocity;
  const Vector6d off = root.matrixL().solve(Vector6d(sample.mean - nominal));
  INFO(off.transpose());
  CHECK(off.cwiseAbs().maxCoeff() < 5 / std::sqrt(count));
}

const Spread& spread_of(const TrialReport& report, std::string_view name) {
  for (const Spread& s : report.spreads) {
    if (s.name == name) return s;
  }
  throw std::logic_error(std::string(name));
}

}  // namespace

TEST_CASE("a trial depends on its number and the seed alone") {
  const Plan plan = planar_plan();
  const Perturbations sizes = perturbations_for(plan.problem);
  const auto all = run_trials(plan, sizes, 5, 0, 12, 1);
  REQUIRE(all.size() == 12);
  for (const int workers : {2, 4}) {
    const auto again = run_trials(plan, sizes, 5, 0, 12, workers);
    for (std::size_t i = 0; i < all.size(); ++i) CHECK(same(all[i], again[i]));
  }
  const auto part = run_trials(plan, sizes, 5, 7, 3, 2);
  for (std::size_t i = 0; i < part.size(); ++i) CHECK(same(part[i], all[7 + i]));
  CHECK_FALSE(same(all[0], all[1]));
  CHECK_FALSE(same(all[0], run_trials(plan, sizes, 6, 0, 1, 1)[0]));
}

TEST_CASE("without perturbation a trial is the plan itself") {
  for (const char* name : {"planar_two_link_c2_a", "iiwa_client_50"}) {
    const Plan plan = planar_plan(name);
    const TrialOutcome outcome = run_trials(plan, nothing(), 1, 0, 1, 1)[0];
    INFO(name);
    CHECK(outcome.hit);
    CHECK(outcome.finished);
    CHECK(outcome.success);
    CHECK(outcome.impulse == Approx(plan.impact.Fbar.head<3>().norm()).epsilon(1e-10));
    CHECK(outcome.base_rate_jump ==
          Approx(plan.impact.Delta_Omega.tail<3>().norm()).epsilon(1e-8).margin(1e-12));
    for (const double x : outcome.inputs) CHECK(x == 0);
  }
}

TEST_CASE("impulses grow with the closing speed, as the sensitivities state") {
  const Plan plan = planar_plan();
  Perturbations sizes = nothing();
  sizes.closing_speed = 0.2;
  sizes.target_mass = 0.01;
  const TrialReport report = summarize_trials(run_trials(plan, sizes, 2, 0, 60, 2));
  REQUIRE(report.trials == 60);
  for (const Sensitivity& s : report.sensitivities) {
    if (s.output != "impulse") continue;
    CHECK(s.input == "closing_speed");  // the first is the strongest
    CHECK(s.rank_correlation > 0.95);
    break;
  }
  const double nominal = plan.impact.Fbar.head<3>().norm();
  const Spread& impulse = spread_of(report, "impulse");
  CHECK(impulse.worst < 1.22 * nominal);
  CHECK(impulse.p5 < impulse.p50);
  CHECK(impulse.p50 < impulse.p95);
  CHECK(std::abs(impulse.mean - nominal) < 0.1 * nominal);
}

TEST_CASE("a posture error that the problem states is drawn per joint") {
  Plan plan = planar_plan();
  plan.problem.post_impact.controllers.clear();
  plan.problem.uncertainty.joint_position = JointVectord::Constant(2, 0.02);
  const auto outcomes = run_trials(plan, stated_alone(plan.problem), 3, 0, 20, 1);
  const double nominal = run_trials(plan, nothing(), 3, 0, 1, 1)[0].impulse;
  for (const TrialOutcome& outcome : outcomes) {
    CHECK(outcome.impulse != nominal);
    CHECK(std::abs(outcome.impulse - nominal) < 0.1 * nominal);
  }
}

TEST_CASE("an error of a predicted target's closing speed is drawn in m/s") {
  Plan plan = planar_plan("iiwa_client_50");
  plan.problem.post_impact.controllers.clear();
  const TrialOutcome nominal = run_trials(plan, nothing(), 3, 0, 1, 1)[0];
  plan.problem.uncertainty.closing_speed = 0.1 * plan.impact.closing_speed;
  double least = 2, most = 0;
  for (const TrialOutcome& outcome : run_trials(plan, stated_alone(plan.problem), 3, 0, 200, 1)) {
    least = std::min(least, outcome.impulse / nominal.impulse);
    most = std::max(most, outcome.impulse / nominal.impulse);
  }
  CHECK(least == Approx(0.9).epsilon(0).margin(0.01));
  CHECK(most == Approx(1.1).epsilon(0).margin(0.01));
}

TEST_CASE("errors of an estimate with covariance are drawn as normal and not cut") {
  Plan plan = planar_plan("ets7_client");
  plan.problem.post_impact.controllers.clear();
  const auto outcomes = run_trials(plan, stated_alone(plan.problem), 3, 0, 2000, 2);
  const double cone = plan.problem.uncertainty.cone_half_angle;
  int outside = 0;
  double impulse = outcomes[0].impulse, spread = 0;
  for (const TrialOutcome& outcome : outcomes) {
    outside += outcome.inputs.at(0) > cone;
    spread = std::max(spread, std::abs(outcome.impulse - impulse));
  }
  // The cone holds 95 % at the worst contact time of the window, more at others.
  CHECK(outside > 2);
  CHECK(outside < 0.07 * 2000);
  CHECK(spread > 1e-3 * impulse);
}

TEST_CASE("a contact below the smallest closing speed is a miss") {
  Plan plan = planar_plan();
  plan.problem.post_impact.controllers.clear();
  plan.problem.constraints.closing_speed_min = 0.99;  // of 1 m/s
  Perturbations sizes = nothing();
  CHECK(run_trials(plan, sizes, 1, 0, 1, 1)[0].hit);
  sizes.closing_speed = 0.05;
  const auto outcomes = run_trials(plan, sizes, 1, 0, 100, 1);
  int hits = 0;
  for (const TrialOutcome& outcome : outcomes) {
    hits += outcome.hit;
    CHECK(outcome.success == outcome.hit);
    CHECK(outcome.hit == (outcome.inputs.at(1) >= -0.01));
  }
  CHECK(hits > 30);
  CHECK(hits < 90);
}

TEST_CASE("what rests but for the errors of the sensors is at rest") {
  CaptureProblem problem = test::without_path("detumble_client_1000");
  problem.search.starts = 8;
  const Plan plan = make_plan(problem);
  const Perturbations sizes = perturbations_for(problem);
  REQUIRE(sizes.base_rate_error > 0);
  const auto outcomes = run_trials(plan, sizes, 1, 0, 12, 2);
  CHECK(count_failures(outcomes, problem.post_impact).empty());
  Perturbations exact = sizes;
  exact.base_rate_error = exact.joint_rate_error = 0;
  for (const TrialOutcome& outcome : run_trials(plan, exact, 1, 0, 4, 2)) CHECK(outcome.success);
}

TEST_CASE("each outcome fails by one thing at most") {
  PostImpactSpec spec;
  spec.controllers = {"rns_damped"};
  spec.residual_base_rate_max = 1;
  spec.attitude_change_max = 1;
  TrialOutcome good;
  good.hit = good.finished = true;
  CHECK(trial_failure(good, spec) == "");
  std::vector<TrialOutcome> outcomes(7, good);
  outcomes[0].hit = false;
  outcomes[1].residual_base_rate = 2;
  outcomes[2].residual_base_rate = std::numeric_limits<double>::quiet_NaN();
  outcomes[3].attitude_turned = 2;
  outcomes[3].stop_hits = 1;
  const std::vector<std::pair<std::string, int>> expected{
      {"base rate", 2}, {"joint stops", 1}, {"no contact", 1}};
  CHECK(count_failures(outcomes, spec) == expected);
  spec.controllers = {"detumble"};
  CHECK(trial_failure(good, spec) == "no rest within the horizon");
  good.rests = true;
  CHECK(trial_failure(good, spec) == "");
}

TEST_CASE("percentiles, mean and worst case are those of the outcomes") {
  std::vector<TrialOutcome> outcomes(101);
  for (int i = 0; i <= 100; ++i) {
    TrialOutcome& o = outcomes[static_cast<std::size_t>((i * 37) % 101)];
    o.inputs.assign(trial_input_names().size(), 0.0);
    o.inputs[1] = i;
    o.inputs[2] = -i * i;
    o.objective = i;
    o.success = i < 80;
  }
  const TrialReport report = summarize_trials(outcomes, 1000);
  const Spread& s = spread_of(report, "objective");
  CHECK(s.mean == Approx(50));
  CHECK(s.p5 == Approx(5));
  CHECK(s.p50 == Approx(50));
  CHECK(s.p99 == Approx(99));
  CHECK(s.worst == 100);
  CHECK(s.worst_trial == 1000 + (100 * 37) % 101);
  CHECK(report.successes == 80);
  std::vector<Sensitivity> of_objective;
  for (const Sensitivity& x : report.sensitivities) {
    if (x.output == "objective") of_objective.push_back(x);
  }
  CHECK(of_objective[0].rank_correlation == Approx(1));
  CHECK(of_objective[1].rank_correlation == Approx(-1));
  CHECK(of_objective[2].rank_correlation == 0);
}

TEST_CASE("Wilson's interval: published values, edges, and coverage") {
  // 95 %: 81 of 263 gives 0.2553 to 0.3662 (Newcombe 1998, table I), 0 of 20 gives 0 to 0.1611.
  CHECK(wilson_interval(81, 263).lower == Approx(0.2553).epsilon(0).margin(5e-5));
  CHECK(wilson_interval(81, 263).upper == Approx(0.3662).epsilon(0).margin(5e-5));
  CHECK(wilson_interval(0, 20).lower == Approx(0).epsilon(0).margin(1e-12));
  CHECK(wilson_interval(0, 20).upper == Approx(0.1611).epsilon(0).margin(5e-5));
  CHECK(wilson_interval(0, 0).upper == 1);
  Random random(1, 9);
  int covered = 0;
  for (int i = 0; i < 1000; ++i) {
    int successes = 0;
    for (int k = 0; k < 50; ++k) successes += random.uniform() < 0.9;
    const Interval interval = wilson_interval(successes, 50);
    covered += interval.lower <= 0.9 && 0.9 <= interval.upper;
  }
  CHECK(covered > 920);
  CHECK(covered < 990);
}

TEST_CASE("a residual velocity is drawn as stated, and the mean is the closed form's") {
  Plan plan = planar_plan("servicer_latch");
  CaptureProblem& problem = plan.problem;
  problem.post_impact.controllers.clear();
  ResidualVelocity& residual = problem.uncertainty.residual_velocity.emplace();
  Matrix6d root = Matrix6d::Zero();
  root.diagonal() << 1e-3, 2e-3, 1e-3, 2e-3, 1e-3, 3e-3;
  root(3, 1) = 1e-3;
  residual.covariance = root * root.transpose();
  const Perturbations sizes = stated_alone(problem);
  CHECK(perturbations_for(problem).closing_speed == 0);  // a part of the residual velocity
  constexpr int kTrials = 4000;
  double linear = 0, angular = 0, mean = 0, squares = 0;
  int hits = 0;
  for (const TrialOutcome& outcome : run_trials(plan, sizes, 7, 0, kTrials, 2)) {
    const std::size_t last = outcome.inputs.size() - 1;
    linear += std::pow(outcome.inputs[last - 1], 2) / kTrials;
    angular += std::pow(outcome.inputs[last], 2) / kTrials;
    const double square = std::pow(outcome.objective, 2);
    mean += square / kTrials;
    squares += square * square / kTrials;
    hits += outcome.hit;
  }
  CHECK(trial_input_names().back() == "rate_error");
  CHECK(linear == Approx(residual.covariance->topLeftCorner<3, 3>().trace()).epsilon(0.1));
  CHECK(angular == Approx(residual.covariance->bottomRightCorner<3, 3>().trace()).epsilon(0.1));
  REQUIRE(hits == kTrials);  // no velocity separates
  problem.measure.kind = RiskMeasure::Expectation;
  const Formulation formulation(problem);
  const double expectation =
      Measure(problem, formulation).reported(formulation.variables(plan.configuration));
  const double error = std::sqrt((squares - mean * mean) / kTrials);
  CHECK(std::abs(expectation * expectation - mean) < 5 * error);
}

TEST_CASE("where the hand moves along, trials have the mean of the closed form") {
  CaptureProblem problem = test::without_path("matched_light");
  problem.search.starts = 2;
  Matrix6d root = Matrix6d::Zero();
  root.diagonal() << 1e-3, 2e-3, 1e-3, 2e-3, 1e-3, 3e-3;
  root(3, 1) = 1e-3;
  problem.uncertainty.residual_velocity.emplace().covariance = root * root.transpose();
  problem.measure.kind = RiskMeasure::Expectation;
  const Plan plan = make_plan(problem);
  REQUIRE(plan.objective.residual);
  constexpr int kTrials = 4000;
  double mean = 0, squares = 0;
  int hits = 0;
  for (const TrialOutcome& outcome : run_trials(plan, stated_alone(problem), 7, 0, kTrials, 2)) {
    const double square = std::pow(outcome.objective, 2);
    mean += square / kTrials;
    squares += square * square / kTrials;
    hits += outcome.hit;
  }
  REQUIRE(hits == kTrials);
  const double error = std::sqrt((squares - mean * mean) / kTrials);
  CHECK(std::abs(std::pow(plan.objective.value, 2) - mean) < 5 * error);
  CHECK(plan.objective.value > plan.objective.nominal);
}

TEST_CASE("a latch whose hand moves along holds a target that drifts away") {
  CaptureProblem problem = test::without_path("matched_light");
  problem.search.starts = 2;
  problem.post_impact.controllers = {"none"};
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(4e-4);  // beside a nominal velocity of 0.017 m/s
  problem.uncertainty.residual_velocity.emplace().covariance = covariance;
  problem.measure.kind = RiskMeasure::Expectation;
  const Plan plan = make_plan(problem);
  REQUIRE(plan.objective.residual);
  CHECK(plan.objective.residual->separating == 0);
  const Vector3d nominal = run_trials(plan, nothing(), 1, 0, 1, 1)[0].target_velocity.head<3>();
  int receding = 0;
  for (const TrialOutcome& outcome : run_trials(plan, stated_alone(problem), 1, 0, 100, 2)) {
    receding += outcome.target_velocity.head<3>().dot(nominal) < 0;
    CHECK(outcome.hit);
    CHECK(outcome.impulse > 0);
  }
  CHECK(receding > 5);  // even from a hand at rest
}

TEST_CASE("the relative velocity of trials has the stated covariance, whatever the estimate has") {
  Plan plan = planar_plan("servicer_latch");
  CaptureProblem& problem = plan.problem;
  problem.post_impact.controllers.clear();
  EstimateDeviations& estimate = problem.target_deviations.emplace();
  estimate.position.setConstant(0.01);
  estimate.orientation.setConstant(0.02);
  estimate.linear_velocity.setConstant(2e-3);
  estimate.angular_velocity.setConstant(1e-3);
  estimate.moments.setConstant(0.05);
  ResidualVelocity& residual = problem.uncertainty.residual_velocity.emplace();
  Matrix6d root = Matrix6d::Zero();
  root.diagonal() << 1e-3, 2e-3, 1e-3, 2e-3, 1e-3, 3e-3;
  root(3, 1) = 1e-3;
  residual.covariance = root * root.transpose();
  problem.uncertainty.contact_time = 5;  // the target rotates by some degrees meanwhile
  Perturbations sizes = stated_alone(problem);
  sizes.contact_time = problem.uncertainty.contact_time;
  constexpr int kTrials = 4000;
  const auto outcomes = run_trials(plan, sizes, 7, 0, kTrials, 2);
  check_sample(plan, sampled_velocity(outcomes), *residual.covariance, kTrials);
  // Place and attitude are those of the estimate: the direction of the contact varies.
  double widest = 0;
  for (const TrialOutcome& outcome : outcomes) widest = std::max(widest, outcome.inputs.at(0));
  CHECK(widest > 0.02);
}

TEST_CASE("a residual velocity carried from the estimate is drawn once") {
  Plan plan = planar_plan("servicer_latch");
  CaptureProblem& problem = plan.problem;
  problem.post_impact.controllers.clear();
  EstimateDeviations& estimate = problem.target_deviations.emplace();
  estimate.linear_velocity.setConstant(1e-3);
  estimate.angular_velocity.setConstant(2e-4);
  ResidualVelocity& residual = problem.uncertainty.residual_velocity.emplace();
  residual.linear_tracking = 5e-4;
  residual.angular_tracking = 3e-4;
  constexpr int kTrials = 4000;
  const auto outcomes = run_trials(plan, stated_alone(problem), 7, 0, kTrials, 2);
  check_sample(plan, sampled_velocity(outcomes),
               ResidualRoot(problem).covariance(plan.configuration.contact_time), kTrials);
}

TEST_CASE("a latch off the hand's origin is simulated with the velocities that were drawn") {
  Plan plan = planar_plan("servicer_latch");
  CaptureProblem& problem = plan.problem;
  problem.post_impact.controllers = {"none"};
  problem.post_impact.horizon = 1e-6;
  ResidualVelocity& residual = problem.uncertainty.residual_velocity.emplace();
  residual.covariance = Matrix6d::Zero();
  residual.covariance->bottomRightCorner<3, 3>().setIdentity();
  *residual.covariance *= 1e-2;  // 6 deg/s, far more than the target's own rate
  Perturbations sizes = stated_alone(problem);
  sizes.contact_point = 0.1;
  for (const TrialOutcome& outcome : run_trials(plan, sizes, 3, 0, 20, 2)) {
    REQUIRE(outcome.finished);
    CHECK(outcome.residual_base_rate == Approx(outcome.base_rate_jump).epsilon(1e-4));
  }
}

TEST_CASE("an estimate whose normal is unknown makes trials fail, and the plan says why") {
  CaptureProblem problem = test::without_path("iiwa_client_50");
  EstimateDeviations& sigma = problem.target_deviations.emplace();
  sigma.angular_velocity.setConstant(2.5 / 180 * kPi);
  const auto narrow = narrow_cone(problem);
  REQUIRE(narrow);
  // Turned at random, a direction is within 154 deg with the probability of 0.95.
  CHECK(narrow->implied > 140 * kPi / 180);
  CHECK(narrow->stated == problem.uncertainty.cone_half_angle);
  problem.search.starts = 4;
  Plan plan = make_plan(problem);
  REQUIRE(plan.warnings.size() == 1);
  CHECK(plan.warnings[0].code == kNarrowConeRule);
  CHECK_THAT(plan.warnings[0].message, Catch::Contains("no cone holds it"));
  int successes = 0;
  for (const TrialOutcome& outcome : run_trials(plan, perturbations_for(problem), 1, 0, 100, 2)) {
    successes += outcome.success;
  }
  CHECK(successes < 90);
}
