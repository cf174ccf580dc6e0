// Joint stops, stick-slip friction and rate limits in the plant.
#include <catch2/catch.hpp>
#include <cmath>
#include <stillbase/simulation/simulate.hpp>

#include "simulation/robots.hpp"

namespace stillbase::test {
namespace {

PlantState moving(const RobotModel& robot, const JointVectord& rates) {
  PlantState state = state_at_rest(Pose(), JointVectord::Zero(robot.n()));
  state.phidot = rates;
  return state;
}

JointVectord rates(double a, double b, double c) {
  JointVectord x(3);
  x << a, b, c;
  return x;
}

SimulationOptions adaptive(double horizon) {
  SimulationOptions options;
  options.integrator = IntegratorKind::Fehlberg78;
  options.horizon = horizon;
  return options;
}

}  // namespace

TEST_CASE("a joint does not pass its stop, and the impulse of the stop conserves momentum",
          "[simulation]") {
  RobotModel robot = planar_three_link();
  robot.joints[0].upper = 0.05;
  robot.joints[1].upper = 0.1;
  robot.joints[2].lower = -0.02;
  for (const double restitution : {0.0, 0.5}) {
    for (const IntegratorKind kind : {IntegratorKind::Rk4, IntegratorKind::Fehlberg78}) {
      SimulationOptions options = adaptive(5);
      options.integrator = kind;
      options.step = 0.002;
      options.stop_restitution = restitution;
      const SimulationResult result =
          simulate_post_impact(robot, {}, moving(robot, rates(0.1, 0.2, -0.1)), {}, options);
      REQUIRE(result.status == SimulationStatus::Finished);
      CHECK(result.summary.stop_hits >= 3);
      CHECK(result.summary.relative_momentum_drift < 1e-9);
      double energy = kInfinity;
      for (const TraceSample& sample : result.trace) {
        CHECK(sample.state.phi[0] <= 0.05 + 1e-9);
        CHECK(sample.state.phi[1] <= 0.1 + 1e-9);
        CHECK(sample.state.phi[2] >= -0.02 - 1e-9);
        CHECK(sample.kinetic_energy <= energy * (1 + 1e-9));
        energy = sample.kinetic_energy;
      }
      CHECK(energy < 0.999 * result.trace.front().kinetic_energy);
    }
  }
}

TEST_CASE("a stop's hit comes at its instant and leaves the stated part of the rate",
          "[simulation]") {
  // One joint alone, no torque, planar: by symmetry of a joint at the base's centroid the rate is
  // constant, so the instant is known.
  RobotModel robot = planar_three_link();
  robot.joints[1].upper = 0.05;
  PlantState state = moving(robot, rates(0, 0.2, 0));
  SimulationOptions options = adaptive(0.6);
  options.output_period = 0;
  options.stop_restitution = 0.4;
  Controller none;
  const SimulationResult result = simulate_post_impact(robot, {}, state, none, options);
  REQUIRE(result.summary.stop_hits == 1);
  REQUIRE(result.summary.limits.size() == 1);
  // The same run up to the reported instant, without stops, ends at the stop.
  options.joint_stops = false;
  options.horizon = result.summary.limits[0].time;
  const SimulationResult free = simulate_post_impact(robot, {}, state, none, options);
  CHECK(free.trace.back().state.phi[1] == Approx(0.05).epsilon(0).margin(1e-10));
  const double before = free.trace.back().state.phidot[1];
  CHECK(result.summary.hardest_stop == Approx(before).epsilon(1e-9));
  options.joint_stops = true;
  options.horizon += 1e-9;
  const SimulationResult after = simulate_post_impact(robot, {}, state, none, options);
  CHECK(after.trace.back().state.phidot[1] == Approx(-0.4 * before).epsilon(1e-6));
}

TEST_CASE("a joint pressed against its stop rests there and leaves it when pulled",
          "[simulation]") {
  RobotModel robot = planar_three_link();
  robot.joints[2].upper = 0.01;
  for (const int k : {0, 1}) robot.joints[static_cast<std::size_t>(k)].coulomb_friction = 1000;
  SimulationOptions options = adaptive(3);
  options.friction = true;
  options.stop_restitution = 0.5;
  // A torque on the base presses the joints in one direction, then in the other.
  options.base_wrench = [](double t, const PlantState&) {
    Vector6d F_b = Vector6d::Zero();
    F_b[5] = t < 2 ? -20.0 : 20.0;
    return F_b;
  };
  Controller none;
  const SimulationResult result =
      simulate_post_impact(robot, {}, state_at_rest(Pose(), JointVectord::Zero(3)), none, options);
  REQUIRE(result.status == SimulationStatus::Finished);
  CHECK(result.summary.stop_hits > 2);  // it rebounds before it rests
  int resting = 0;
  for (const TraceSample& sample : result.trace) {
    if (sample.time > 1.5 && sample.time < 1.9 && sample.state.phidot[2] == 0) ++resting;
  }
  CHECK(resting > 30);
  CHECK(result.trace.back().state.phi[2] < 0.01 - 1e-4);
}

TEST_CASE("a sticking joint does not move", "[simulation]") {
  RobotModel robot = planar_three_link();
  for (Joint& joint : robot.joints) joint.coulomb_friction = 0.2;
  SimulationOptions options = adaptive(20);
  options.friction = true;
  options.output_period = 0.5;
  const SimulationResult result =
      simulate_post_impact(robot, {}, moving(robot, rates(0.3, -0.2, 0.25)), {}, options);
  REQUIRE(result.status == SimulationStatus::Finished);
  const TraceSample& last = result.trace.back();
  CHECK(last.state.phidot.norm() == 0);  // exactly: not creeping
  const TraceSample& before = result.trace[result.trace.size() - 4];
  CHECK(last.state.phi == before.state.phi);
  CHECK(last.state.Omega[5] != 0);  // the base turns on with the momentum
  CHECK(result.summary.relative_momentum_drift < 1e-9);
}

TEST_CASE("a stuck joint slips beyond its friction torque", "[simulation]") {
  RobotModel robot = planar_three_link();
  for (Joint& joint : robot.joints) joint.coulomb_friction = 0.2;
  SimulationOptions options = adaptive(4);
  options.friction = true;
  // A moment on the base that grows: the joints hold until the arm's inertia asks for more.
  options.base_wrench = [](double t, const PlantState&) {
    Vector6d F_b = Vector6d::Zero();
    F_b[5] = 2 * t;
    return F_b;
  };
  const SimulationResult result =
      simulate_post_impact(robot, {}, state_at_rest(Pose(), JointVectord::Zero(3)), {}, options);
  REQUIRE(result.status == SimulationStatus::Finished);
  CHECK(result.trace[10].state.phidot.norm() == 0);
  CHECK(result.trace[10].state.Omega[5] > 0);
  CHECK(result.trace.back().state.phidot[0] < 0);  // the arm stays behind
}

TEST_CASE("a drive at its rate limit gives no more torque in that direction", "[simulation]") {
  RobotModel robot = planar_two_link('A');
  Controller controller;
  controller.kind = ControllerKind::Rns;
  PlantState state = state_at_rest(Pose(), JointVectord::Zero(2));
  state.phi << -80 * kDegree, 160 * kDegree;
  state.Omega[5] = 0.05;
  SimulationOptions options = adaptive(2);
  const SimulationResult free = simulate_post_impact(robot, {}, state, controller, options);
  const double most = free.summary.peak_joint_rates[0];
  robot.joints[0].max_velocity = 0.5 * most;
  const SimulationResult limited = simulate_post_impact(robot, {}, state, controller, options);
  CHECK(limited.summary.peak_joint_rates[0] < 0.7 * most);
  CHECK(limited.summary.residual_base_rate > 10 * free.summary.residual_base_rate);
}

}  // namespace stillbase::test
