// Wheels, hand-back, and controllers with errors of model and measurement.
#include <catch2/catch.hpp>
#include <cmath>
#include <stillbase/core/error.hpp>
#include <stillbase/simulation/simulate.hpp>

#include "simulation/robots.hpp"

namespace stillbase::test {
namespace {

PlantState struck(const RobotModel& robot) {
  PlantState rest = state_at_rest(Pose(), JointVectord::Zero(robot.n()));
  if (robot.n() == 2) {
    rest.phi << -80 * kDegree, 160 * kDegree;
  } else {
    for (int k = 0; k < robot.n(); ++k) rest.phi[k] = 0.5 - 0.3 * k;
  }
  Vector6d Fbar = Vector6d::Zero();
  Fbar.head<3>() << -45, 8, robot.n() == 2 ? 0.0 : 3.0;
  return state_after_impact(robot, {}, rest, Fbar);
}

Controller controller(ControllerKind kind) {
  Controller c;
  c.kind = kind;
  return c;
}

SimulationOptions options_for(double horizon) {
  SimulationOptions options;
  options.integrator = IntegratorKind::Dopri5;
  options.horizon = horizon;
  options.control_period = 0.005;
  options.output_period = 0.05;
  return options;
}

}  // namespace

TEST_CASE("rns_handback gives the momentum to the wheels and the arm stops", "[simulation]") {
  const RobotModel robot = planar_two_link('A');
  const PlantState state = struck(robot);
  SimulationOptions options = options_for(40);
  options.wheels.torque.setConstant(2);
  const SimulationResult result =
      simulate_post_impact(robot, {}, state, controller(ControllerKind::RnsHandback), options);
  REQUIRE(result.status == SimulationStatus::Finished);
  const TraceSample& first = result.trace.front();
  const TraceSample& last = result.trace.back();
  // All of it is in the wheels, in N; the pair keeps it.
  CHECK(last.total.norm() < 1e-3 * first.total.norm());
  const Vector3d wheels_N = last.state.base.orientation * last.state.wheel_momentum;
  CHECK((wheels_N - first.total_N).norm() < 2e-3 * first.total_N.norm());
  CHECK(result.summary.relative_momentum_drift < 1e-8);
  CHECK(last.state.Omega.tail<3>().norm() < 1e-4);
  CHECK(last.state.phidot.norm() < 0.01 * first.state.phidot.norm());
  CHECK(result.summary.peak_wheel_torque == Approx(2));
  // The base stays as still as before while it happens.
  for (const TraceSample& sample : result.trace) {
    if (sample.time > 2) CHECK(sample.state.Omega.tail<3>().norm() < 1e-3);
    if (sample.time < 1.99) CHECK(sample.wheel_torque.norm() == 0);
  }
}

TEST_CASE("without wheels rns_handback is rns_damped", "[simulation]") {
  const RobotModel robot = planar_two_link('B');
  const PlantState state = struck(robot);
  const SimulationResult a = simulate_post_impact(
      robot, {}, state, controller(ControllerKind::RnsHandback), options_for(5));
  const SimulationResult b =
      simulate_post_impact(robot, {}, state, controller(ControllerKind::RnsDamped), options_for(5));
  CHECK(a.trace.back().state.phidot == b.trace.back().state.phidot);
}

TEST_CASE("full wheels take no more, the remaining momentum stays in the arm", "[simulation]") {
  const RobotModel robot = planar_two_link('A');
  const PlantState state = struck(robot);
  SimulationOptions options = options_for(30);
  options.wheels = {Vector3d::Constant(2), Vector3d::Constant(5)};
  const SimulationResult result =
      simulate_post_impact(robot, {}, state, controller(ControllerKind::RnsHandback), options);
  const double total = result.trace.front().total.norm();
  REQUIRE(total > 10);
  CHECK(result.summary.wheel_momentum.norm() == Approx(5).epsilon(0.01));
  CHECK(result.trace.back().total.norm() == Approx(total - 5).epsilon(0.01));
  CHECK(result.trace.back().state.Omega.tail<3>().norm() < 1e-3);
}

TEST_CASE("the SPART arm under every controller keeps its torques finite", "[simulation]") {
  const RobotModel robot = spart_3dof();
  const PlantState state = struck(robot);
  for (const std::string& name : controller_names()) {
    SimulationOptions options = options_for(5);
    options.wheels.torque.setConstant(0.5);
    const SimulationResult result =
        simulate_post_impact(robot, {}, state, controller(*controller_from_name(name)), options);
    INFO(name);
    REQUIRE(result.status == SimulationStatus::Finished);
    CHECK(result.summary.peak_torque < 1e4);
    if (is_reaction_null_space_control(*controller_from_name(name))) {
      CHECK(result.summary.lowest_rank <= 2);
      CHECK(result.summary.peak_lost_momentum > 0);
    }
  }
}

TEST_CASE("sensor errors, delay and a wrong model each make the control worse, and repeatably",
          "[simulation]") {
  const RobotModel robot = planar_two_link('A');
  const PlantState state = struck(robot);
  const Controller rns = controller(ControllerKind::RnsDamped);
  const auto residual = [&](const SimulationOptions& options) {
    const SimulationResult result = simulate_post_impact(robot, {}, state, rns, options);
    REQUIRE(result.status == SimulationStatus::Finished);
    return result.summary.residual_base_rate;
  };
  const double exact = residual(options_for(4));
  SimulationOptions noisy = options_for(4);
  noisy.sensors.base_rate_error = 1e-3;
  noisy.sensors.joint_rate_error = 1e-3;
  noisy.sensors.seed = 5;
  const double with_noise = residual(noisy);
  CHECK(with_noise > 10 * exact);
  CHECK(residual(noisy) == with_noise);
  noisy.sensors.stream = 1;
  CHECK(residual(noisy) != with_noise);

  // What the delay does shows early: after 0.2 s the base has lost less of its rate.
  SimulationOptions late = options_for(0.2);
  const double undelayed = residual(late);
  late.sensors.delay = 0.03;
  CHECK(std::abs(residual(late) - undelayed) > 0.02 * undelayed);
  late.sensors.delay = 0.0312;
  CHECK_THROWS_AS(simulate_post_impact(robot, {}, state, rns, late), InputError);

  SimulationOptions wrong = options_for(4);
  wrong.controller_robot = robot;
  CHECK(residual(wrong) == exact);
  for (Body& body : wrong.controller_robot->bodies) body.mass *= 1.2;
  CHECK(residual(wrong) != exact);
}

TEST_CASE("friction in the model of the controller changes the result little", "[simulation]") {
  RobotModel robot = planar_two_link('A');
  for (Joint& joint : robot.joints) {
    joint.viscous_friction = 5;
    joint.coulomb_friction = 1;
  }
  const PlantState state = struck(robot);
  SimulationOptions options = options_for(4);
  options.friction = true;
  Controller rns = controller(ControllerKind::RnsDamped);
  const double unknown =
      simulate_post_impact(robot, {}, state, rns, options).summary.residual_base_rate;
  rns.friction_compensation = true;
  const double known =
      simulate_post_impact(robot, {}, state, rns, options).summary.residual_base_rate;
  CHECK(known < 0.1 * unknown);
}

}  // namespace stillbase::test
