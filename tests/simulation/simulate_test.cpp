// Options, limits, endings and the trace's text.
#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <sstream>
#include <stillbase/core/error.hpp>
#include <stillbase/simulation/simulate.hpp>

#include "simulation/robots.hpp"

namespace stillbase::test {
namespace {

SimulationOptions short_run(double horizon = 0.5) {
  SimulationOptions options;
  options.horizon = horizon;
  return options;
}

Controller damping() {
  Controller controller;
  controller.kind = ControllerKind::JointDamping;
  return controller;
}

PlantState moving(const RobotModel& robot, double rate) {
  PlantState state = state_at_rest(Pose(), JointVectord::Zero(robot.n()));
  state.phidot.setConstant(rate);
  return state;
}

}  // namespace

TEST_CASE("torque limits clip the controller and are reported", "[simulation]") {
  RobotModel robot = planar_three_link();
  for (Joint& joint : robot.joints) joint.max_effort = 0.5;
  const PlantState state = moving(robot, 0.3);
  const SimulationResult clipped = simulate_post_impact(robot, {}, state, damping(), short_run());
  CHECK(clipped.summary.peak_torque == 0.5);
  CHECK(clipped.trace.front().tau.cwiseAbs().maxCoeff() == 0.5);
  REQUIRE_FALSE(clipped.summary.limits.empty());
  CHECK(clipped.summary.limits.front().kind == LimitKind::Torque);
  CHECK(clipped.summary.limits.front().time == 0);

  SimulationOptions unlimited = short_run();
  unlimited.torque_limits = false;
  const SimulationResult free = simulate_post_impact(robot, {}, state, damping(), unlimited);
  CHECK(free.summary.peak_torque > 0.5);
  CHECK(free.summary.peak_demanded_torque == free.summary.peak_torque);
  // The torque that is demanded is the same, limits or not.
  CHECK(clipped.summary.peak_demanded_torque >= free.summary.peak_demanded_torque);
  CHECK(clipped.trace.front().demanded_tau == free.trace.front().tau);
  CHECK(free.summary.limits.empty());
  CHECK(free.summary.residual_joint_rate < clipped.summary.residual_joint_rate);
}

TEST_CASE("passing a joint stop is reported with its time", "[simulation]") {
  RobotModel robot = planar_three_link();
  robot.joints[1].upper = 0.05;
  robot.joints[2].lower = -0.02;
  PlantState state = moving(robot, 0);
  state.phidot[1] = 0.2;
  state.phidot[2] = -0.1;
  Controller controller;
  controller.kind = ControllerKind::JointDamping;
  controller.K_phi = 1;
  SimulationOptions options = short_run(2);
  options.control_period = 0;
  options.joint_stops = false;
  const SimulationResult result = simulate_post_impact(robot, {}, state, controller, options);
  REQUIRE(result.summary.limits.size() == 2);
  // phi(t) = phidot(0) (1 - exp(-t)).
  const LimitEvent &first = result.summary.limits[0], &second = result.summary.limits[1];
  CHECK(first.kind == LimitKind::LowerStop);
  CHECK(first.joint == 2);
  CHECK(first.time == Approx(-std::log(1 - 0.2)).epsilon(0).margin(1e-7));
  CHECK(second.kind == LimitKind::UpperStop);
  CHECK(second.joint == 1);
  CHECK(second.time == Approx(-std::log(1 - 0.25)).epsilon(0).margin(1e-7));
}

TEST_CASE("exceeding a joint's rate limit is reported", "[simulation]") {
  RobotModel robot = planar_three_link();
  robot.joints[0].max_velocity = 0.1;
  const SimulationResult result =
      simulate_post_impact(robot, {}, moving(robot, 0.2), damping(), short_run());
  REQUIRE(result.summary.limits.size() == 1);
  CHECK(result.summary.limits[0].kind == LimitKind::Rate);
  CHECK(result.summary.limits[0].joint == 0);
}

TEST_CASE("joint friction alone does the work of joint damping", "[simulation]") {
  RobotModel robot = planar_three_link();
  for (Joint& joint : robot.joints) {
    joint.viscous_friction = 20;
    joint.coulomb_friction = 0.1;
  }
  PlantState state = moving(robot, 0.3);
  state.Omega[5] = 0.05;
  SimulationOptions options = short_run(40);
  options.integrator = IntegratorKind::Dopri5;
  options.output_period = 1;
  const SimulationResult frictionless =
      simulate_post_impact(robot, {}, state, Controller{}, options);
  CHECK(frictionless.summary.residual_joint_rate > 0.05);
  options.friction = true;
  const SimulationResult result = simulate_post_impact(robot, {}, state, Controller{}, options);
  REQUIRE(result.status == SimulationStatus::Finished);
  // What is left is what the turning base pulls beyond the friction.
  CHECK(result.summary.residual_joint_rate < 0.01 * state.phidot.norm());
  CHECK(result.trace.back().base.z() == Approx(result.trace.front().total.z()).epsilon(0.01));
  CHECK(result.summary.relative_momentum_drift < 1e-8);
  for (std::size_t i = 1; i < result.trace.size(); ++i) {
    CHECK(result.trace[i].kinetic_energy <= result.trace[i - 1].kinetic_energy * (1 + 1e-9));
  }
}

TEST_CASE("a servo or locked joints end with the impact, rotors stay", "[simulation]") {
  const RobotModel robot = planar_three_link();
  PlantState rest = state_at_rest(Pose(), JointVectord::Constant(3, 0.4));
  Vector6d Fbar = Vector6d::Zero();
  Fbar[0] = -1;
  JointResistance locked;
  locked.model = ResistanceModel::Locked;
  locked.locked = {true, true, true};
  const PlantState rigid = state_after_impact(robot, locked, rest, Fbar);
  CHECK(rigid.phidot.norm() == 0);
  CHECK(rigid.Omega.norm() > 0);
  SimulationOptions options = short_run(1);
  const SimulationResult freed = simulate_post_impact(robot, locked, rigid, Controller{}, options);
  CHECK(freed.summary.residual_joint_rate > 1e-6);  // centrifugal: the joints are free afterwards

  JointResistance rotors;
  rotors.model = ResistanceModel::RotorInertia;
  rotors.rotor_inertia = JointVectord::Constant(3, 5);
  const SimulationResult hit =
      simulate_impact(robot, rotors, rest, Fbar, 0.1, Controller{}, options);
  CHECK(hit.summary.peak_joint_rate > 0);
  CHECK(hit.trace.back().kinetic_energy ==
        Approx(hit.trace[hit.trace.size() - 101].kinetic_energy).epsilon(1e-9));
}

TEST_CASE("interval lengths that no step divides end at the horizon all the same", "[simulation]") {
  const RobotModel robot = planar_three_link();
  SimulationOptions options = short_run(0.1234);
  options.control_period = 0.007;
  options.output_period = 0.011;
  for (const IntegratorKind kind :
       {IntegratorKind::Rk4, IntegratorKind::Dopri5, IntegratorKind::Fehlberg78}) {
    options.integrator = kind;
    const SimulationResult result =
        simulate_post_impact(robot, {}, moving(robot, 0.2), damping(), options);
    REQUIRE(result.status == SimulationStatus::Finished);
    CHECK(result.trace.back().time == 0.1234);
    REQUIRE(result.trace.size() == 13);
    for (std::size_t i = 0; i < 12; ++i) {
      CHECK(result.trace[i].time ==
            Approx(0.011 * static_cast<double>(i)).epsilon(0).margin(1e-15));
    }
  }
}

TEST_CASE("a stopped run states the reason and keeps its trace", "[simulation]") {
  const RobotModel robot = planar_three_link();
  const std::atomic<bool> interrupted = true;
  SimulationOptions options = short_run();
  options.stop.interrupted = &interrupted;
  SimulationResult result = simulate_post_impact(robot, {}, moving(robot, 0.2), damping(), options);
  CHECK(result.status == SimulationStatus::Interrupted);
  CHECK(result.trace.size() == 1);

  options = short_run();
  options.stop.deadline = StopCondition::Clock::now();
  result = simulate_post_impact(robot, {}, moving(robot, 0.2), damping(), options);
  CHECK(result.status == SimulationStatus::TimeLimit);

  options = short_run();
  options.max_steps = 5;
  for (const IntegratorKind kind : {IntegratorKind::Rk4, IntegratorKind::Fehlberg78}) {
    options.integrator = kind;
    result = simulate_post_impact(robot, {}, moving(robot, 0.2), damping(), options);
    CHECK(result.status == SimulationStatus::StepLimit);
    CHECK(result.summary.steps == 5);
    CHECK(result.trace.back().time == Approx(0.05));
  }
}

TEST_CASE("a run ends where what it has shown is enough", "[simulation]") {
  const RobotModel robot = planar_three_link();
  const PlantState state = moving(robot, 0.3);
  const SimulationResult whole = simulate_post_impact(robot, {}, state, {}, short_run());
  SimulationOptions options = short_run();
  const double enough = whole.summary.attitude_turned / 4;
  options.ends_when = [&](const SimulationSummary& so_far) {
    return so_far.attitude_turned > enough;
  };
  const SimulationResult part = simulate_post_impact(robot, {}, state, {}, options);
  CHECK(part.status == SimulationStatus::Finished);
  CHECK(part.summary.attitude_turned > enough);
  const double end = part.trace.back().time;
  CHECK(end < 0.4);
  // Up to there it is the whole run.
  const auto there = std::find_if(whole.trace.begin(), whole.trace.end(),
                                  [&](const TraceSample& s) { return s.time == end; });
  REQUIRE(there != whole.trace.end());
  CHECK(there->state.phi == part.trace.back().state.phi);
  options.ends_when = [](const SimulationSummary&) { return false; };
  CHECK(simulate_post_impact(robot, {}, state, {}, options).trace.back().time ==
        whole.trace.back().time);
}

TEST_CASE("a run that diverges ends with its last good state", "[simulation]") {
  const RobotModel robot = planar_three_link();
  Controller unstable = damping();
  unstable.K_phi = 5000;  // far beyond what a 10 ms hold can carry
  for (const IntegratorKind kind :
       {IntegratorKind::Rk4, IntegratorKind::Dopri5, IntegratorKind::Fehlberg78}) {
    SimulationOptions options = short_run(20);
    options.integrator = kind;
    options.max_steps = 200000;
    const SimulationResult result =
        simulate_post_impact(robot, {}, moving(robot, 0.2), unstable, options);
    CHECK(result.status != SimulationStatus::Finished);
    for (const TraceSample& sample : result.trace) {
      CHECK(sample.state.phidot.allFinite());
      CHECK(std::isfinite(sample.kinetic_energy));
    }
    CHECK(std::isfinite(result.summary.peak_torque));
    CHECK(std::isfinite(result.summary.relative_momentum_drift));
  }
}

TEST_CASE("options without sense are refused together", "[simulation]") {
  const RobotModel robot = planar_three_link();
  SimulationOptions options = short_run();
  options.step = 0;
  options.horizon = std::nan("");
  Controller controller = damping();
  controller.K_phi = -1;
  PlantState state = moving(robot, 0.1);
  state.phi.resize(2);
  state.phi.setZero();
  try {
    (void)simulate_post_impact(robot, {}, state, controller, options);
    FAIL("not refused");
  } catch (const InputError& error) {
    CHECK(error.findings().size() == 4);
  }
}

TEST_CASE("the trace's text has units in its header and reads back exactly", "[simulation]") {
  RobotModel robot = planar_three_link();
  robot.joints[0].name = "a, \"b\"";
  robot.joints[2].type = JointType::Prismatic;
  const SimulationResult result =
      simulate_post_impact(robot, {}, moving(robot, 0.1), damping(), short_run(0.02));
  std::istringstream text(trace_csv(robot, result.trace));
  std::string line;
  REQUIRE(std::getline(text, line));
  CHECK(line.rfind("time_s,base_position_x_m,", 0) == 0);
  CHECK(line.find(",\"a, \"\"b\"\"_position_rad\",joint2_position_rad,joint3_position_m,") !=
        std::string::npos);
  CHECK(line.find(",joint2_torque_Nm,joint3_torque_N,") != std::string::npos);
  std::size_t rows = 0;
  while (std::getline(text, line)) {
    std::istringstream fields(line);
    std::vector<double> numbers;
    for (std::string field; std::getline(fields, field, ',');) {
      numbers.push_back(std::stod(field));
    }
    REQUIRE(numbers.size() == 1 + 3 + 4 + 6 + 6 * 3 + 5 * 3 + 1 + 6 * 3);
    CHECK(numbers[0] == result.trace[rows].time);
    CHECK(numbers[14] == result.trace[rows].state.phi[0]);
    CHECK(numbers[numbers.size() - 19] == result.trace[rows].kinetic_energy);
    ++rows;
  }
  CHECK(rows == 3);
}

}  // namespace stillbase::test
