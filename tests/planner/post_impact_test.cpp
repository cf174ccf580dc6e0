// The planner's own verdict on the motion after the impact.
#include <catch2/catch.hpp>
#include <cmath>

#include <stillbase/encounter/encounter.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "planner/after_impact.hpp"
#include "planner/contact_case.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {

TEST_CASE("a controller that demands more than a joint's torque limit breaks a limit") {
  CaptureProblem problem = test::shipped("planar_two_link_post_impact_a");
  const Configuration at{problem.start, problem.base};
  const ImpactSummary impact = impact_at(problem, at);
  CHECK(post_impact_failure(problem, at, impact, {}) == "");
  // The base stays as still as before: the limit of one joint is just below what it is asked for.
  const AfterContact run =
      simulate_post_impact(problem, at, impact, problem.post_impact.controllers.front(), {});
  const SimulationSummary& summary = run.simulation.summary;
  problem.robot.joints[0].max_effort = 0.999 * summary.peak_demanded_torques[0];
  problem.post_impact.residual_base_rate_max = 1;
  problem.post_impact.attitude_change_max = 3;
  CHECK(post_impact_failure(problem, at, impact, {}) ==
        problem.robot.joints[0].name + " exceeds its torque limit");
}

TEST_CASE("a plan that is known to hold keeps its limits after the impact") {
  CaptureProblem problem = test::shipped("iiwa_client_50");
  problem.search.starts = 8;
  const Plan holds = make_plan(problem);
  CHECK(holds.is_known_to_hold);
  CHECK(post_impact_failure(holds) == "");
  problem.post_impact.attitude_change_max = 1e-6;
  const Plan breaks = make_plan(problem);
  CHECK_FALSE(breaks.is_known_to_hold);
  CHECK(post_impact_failure(breaks) != "");
}

TEST_CASE("limits far from what a run uses and just beside it are judged alike") {
  CaptureProblem problem = test::shipped("planar_two_link_post_impact_a");
  problem.post_impact.controllers = {"none"};  // base and joints go on turning
  const Configuration at{problem.start, problem.base};
  const ImpactSummary impact = impact_at(problem, at);
  const SimulationSummary exact =
      simulate_post_impact(problem, at, impact, "none").simulation.summary;
  REQUIRE(exact.attitude_turned > 0);
  REQUIRE(exact.residual_base_rate > 0);
  PostImpactSpec& limits = problem.post_impact;
  // Runs at fixed steps decide the outer ones, runs with error control the others.
  for (const double part : {0.8, 0.985, 0.9999, 1.0001, 1.005, 1.2}) {
    INFO(part);
    limits.attitude_change_max = part * exact.attitude_turned;
    limits.residual_base_rate_max = 10 * exact.residual_base_rate;
    CHECK(post_impact_failure(problem, at, impact, {}) ==
          (part < 1 ? "attitude change of the base" : ""));
    limits.attitude_change_max = 10 * exact.attitude_turned;
    limits.residual_base_rate_max = part * exact.residual_base_rate;
    CHECK(post_impact_failure(problem, at, impact, {}) == (part < 1 ? "base rate" : ""));
  }
}

TEST_CASE("a joint that moves at the horizon is followed to its stop") {
  CaptureProblem problem = test::shipped("planar_two_link_post_impact_a");
  const Configuration at{problem.start, problem.base};
  const ImpactSummary impact = impact_at(problem, at);
  problem.post_impact.horizon = 1;
  const auto free = motion_after_horizon(problem, at, impact, "none");
  REQUIRE(free);
  REQUIRE(free->moves);
  CHECK(free->joint_rate > 0);

  // Without a controller the joints go on: stops just in front of where they come to within three
  // horizons are reached there, by the motion of a longer horizon.
  CaptureProblem longer = problem;
  longer.post_impact.horizon = 3;
  const AfterContact run = simulate_post_impact(longer, at, impact, "none");
  const PlantState& there = run.simulation.trace.back().state;
  const int k = std::abs(there.phidot[0]) > std::abs(there.phidot[1]) ? 0 : 1;
  Joint& joint = problem.robot.joints[static_cast<std::size_t>(k)];
  (there.phidot[k] > 0 ? joint.upper : joint.lower) = there.phi[k];
  const auto stopped = motion_after_horizon(problem, at, impact, "none");
  REQUIRE(stopped);
  REQUIRE(stopped->stop_time);
  CHECK(stopped->joint == joint.name);
  CHECK(*stopped->stop_time == Approx(3).epsilon(1e-6));
  // Within the horizon nothing is reached, so the limits hold all the same.
  problem.post_impact.residual_base_rate_max = 10;
  problem.post_impact.attitude_change_max = 3;
  problem.post_impact.controllers = {"none"};
  CHECK(post_impact_failure(problem, at, impact, {}) == "");
}

TEST_CASE("a motion is stated by fixed steps where it is slow, by adaptive ones where it is fast") {
  const CaptureProblem problem = test::shipped("iiwa_client_50");
  const Configuration at{problem.start, problem.base};
  const PostImpactSpec& spec = problem.post_impact;
  const Controller controller = *controller_of(spec, "joint_damping");
  ContactCase subject = contact_case(problem, at, impact_at(problem, at));
  const auto rate_after = [&](const AfterContact& run) {
    return run.simulation.trace.back().state.phidot.norm();
  };
  const auto adaptive = [&] {
    return rate_after(
        simulate_after_contact(subject, spec, controller, judging_options(problem, {})));
  };
  subject.after.phidot.setConstant(0.05);
  const double slow = rate_after(motion_to_horizon(problem, subject, controller, {}));
  CHECK(slow != adaptive());
  CHECK(slow == Approx(adaptive()).epsilon(1e-8));
  subject.after.phidot.setConstant(5);
  CHECK(rate_after(motion_to_horizon(problem, subject, controller, {})) == adaptive());
}

TEST_CASE("a motion too fast for fixed steps is judged by adaptive ones") {
  CaptureProblem problem = test::shipped("iiwa_client_50");
  problem.post_impact.horizon = 0.2;
  for (Joint& joint : problem.robot.joints) joint.lower = -kInfinity, joint.upper = kInfinity;
  const Configuration at{problem.start, problem.base};
  const PostImpactSpec& spec = problem.post_impact;
  const Controller controller = *controller_of(spec, "joint_damping");
  ContactCase subject = contact_case(problem, at, impact_at(problem, at));
  subject.after.phidot.setConstant(300);
  SimulationOptions fixed = judging_options(problem, {});
  fixed.integrator = IntegratorKind::Rk4;
  fixed.step = 0.01;
  const auto status_after = [&](const SimulationOptions& options) {
    return simulate_after_contact(subject, spec, controller, options).simulation.status;
  };
  REQUIRE(status_after(fixed) == SimulationStatus::Diverged);
  REQUIRE(status_after(judging_options(problem, {})) == SimulationStatus::Finished);
  CHECK(motion_to_horizon(problem, subject, controller, {}).simulation.status ==
        SimulationStatus::Finished);
}

TEST_CASE("joints that rest at their stops state when they reached them") {
  CaptureProblem problem = test::shipped("planar_two_link_post_impact_a");
  const Configuration at{problem.start, problem.base};
  const ImpactSummary impact = impact_at(problem, at);
  problem.post_impact.horizon = 5;
  const std::string damping = "joint_damping";
  const AfterContact run = simulate_post_impact(problem, at, impact, damping);
  const JointVectord turned = run.simulation.trace.back().state.phi - at.phi;
  REQUIRE(turned.cwiseAbs().minCoeff() > 1e-3);
  for (int k = 0; k < 2; ++k) {
    Joint& joint = problem.robot.joints[static_cast<std::size_t>(k)];
    (turned[k] > 0 ? joint.upper : joint.lower) = at.phi[k] + turned[k] / 2;
  }
  const auto stopped = motion_after_horizon(problem, at, impact, damping);
  REQUIRE(stopped);
  CHECK_FALSE(stopped->moves);
  REQUIRE(stopped->stop_time);
  CHECK(*stopped->stop_time < 5);
  CHECK_FALSE(stopped->joint.empty());
}

TEST_CASE("a joint that rests at the horizon has no time after it") {
  CaptureProblem problem = test::shipped("planar_two_link_post_impact_a");
  const Configuration at{problem.start, problem.base};
  ImpactSummary impact = impact_at(problem, at);
  impact.Fbar.setZero();
  const auto after = motion_after_horizon(problem, at, impact, "none");
  REQUIRE(after);
  CHECK_FALSE(after->moves);
  CHECK_FALSE(after->stop_time.has_value());
}

}  // namespace stillbase
