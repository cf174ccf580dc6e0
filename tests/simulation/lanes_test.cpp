// Runs side by side against single runs.
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <stillbase/core/error.hpp>
#include <stillbase/impact/attach_target.hpp>
#include <stillbase/simulation/simulate.hpp>

#include "simulation/robots.hpp"
#include "support/coupled_robot.hpp"

namespace stillbase::test {
namespace {

/// Runs of one arm whose masses, states and sensor errors differ.
std::vector<PostImpactRun> many_runs(const RobotModel& robot, int count, Random& random,
                                     const SimulationOptions& options) {
  std::vector<PostImpactRun> runs;
  for (int i = 0; i < count; ++i) {
    PostImpactRun run{robot, {}, random_state(random, robot.n(), 0.1), options};
    run.initial.wheel_momentum = 0.2 * random.unit_vector();
    for (Body& body : run.robot.bodies) {
      body.mass *= random.uniform(0.9, 1.1);
      body.inertia *= random.uniform(0.9, 1.1);
      body.centroid += 0.01 * random.unit_vector();
    }
    run.robot.base.mass *= random.uniform(0.9, 1.1);
    run.robot.p_hand += 0.01 * random.unit_vector();
    run.options.sensors.stream = static_cast<std::uint64_t>(i);
    runs.push_back(run);
  }
  return runs;
}

SimulationResult single(const PostImpactRun& run, const Controller& controller) {
  return simulate_post_impact(run.robot, run.resistance, run.initial, controller, run.options);
}

void check_same(const SimulationResult& lane, const SimulationResult& one, double tolerance) {
  const auto same = [&](double a, double b) {
    CHECK(std::abs(a - b) <= tolerance * std::max(1.0, std::abs(b)));
  };
  const auto all_same = [&](const auto& a, const auto& b) {
    REQUIRE(a.size() == b.size());
    for (Eigen::Index i = 0; i < b.size(); ++i) same(a(i), b(i));
  };
  REQUIRE(lane.status == one.status);
  const SimulationSummary &a = lane.summary, &b = one.summary;
  CHECK(a.steps == b.steps);
  same(a.peak_base_rate, b.peak_base_rate);
  same(a.residual_base_rate, b.residual_base_rate);
  same(a.attitude_turned, b.attitude_turned);
  same(a.peak_joint_rate, b.peak_joint_rate);
  all_same(a.peak_joint_rates, b.peak_joint_rates);
  all_same(a.peak_torques, b.peak_torques);
  all_same(a.peak_demanded_torques, b.peak_demanded_torques);
  all_same(a.lowest_positions, b.lowest_positions);
  all_same(a.highest_positions, b.highest_positions);
  all_same(a.lost_momentum, b.lost_momentum);
  all_same(a.near_limit.joint_torques, b.near_limit.joint_torques);
  same(a.peak_grip_force, b.peak_grip_force);
  same(a.peak_grip_moment, b.peak_grip_moment);
  CHECK(a.lowest_rank == b.lowest_rank);
  CHECK(a.relative_momentum_drift == Approx(b.relative_momentum_drift).margin(1e-12));
  REQUIRE(a.limits.size() == b.limits.size());
  for (std::size_t i = 0; i < b.limits.size(); ++i) {
    CHECK(a.limits[i].joint == b.limits[i].joint);
    CHECK(a.limits[i].kind == b.limits[i].kind);
    same(a.limits[i].time, b.limits[i].time);
  }
  REQUIRE(a.rest_time.has_value() == b.rest_time.has_value());
  REQUIRE(lane.trace.size() == one.trace.size());
  for (std::size_t i = 0; i < one.trace.size(); ++i) {
    const TraceSample &x = lane.trace[i], &y = one.trace[i];
    same(x.time, y.time);
    all_same(x.state.phi, y.state.phi);
    all_same(x.state.phidot, y.state.phidot);
    all_same(x.state.Omega, y.state.Omega);
    all_same(x.state.base.position, y.state.base.position);
    same(x.state.base.orientation.angularDistance(y.state.base.orientation), 0);
    all_same(x.total_N, y.total_N);
    all_same(x.P_N, y.P_N);
    all_same(x.base, y.base);
    all_same(x.rns, y.rns);
    all_same(x.tau, y.tau);
    all_same(x.grip_wrench, y.grip_wrench);
    same(x.kinetic_energy, y.kinetic_energy);
  }
}

SimulationOptions brief_options(IntegratorKind integrator) {
  SimulationOptions options;
  options.integrator = integrator;
  options.horizon = 0.5;
  options.output_period = 0;
  return options;
}

Controller controller_with(ControllerKind kind) {
  Controller c;
  c.kind = kind;
  return c;
}

}  // namespace

TEST_CASE("runs side by side are those of single runs", "[simulation]") {
  const auto kind =
      GENERATE(ControllerKind::None, ControllerKind::JointDamping,
               ControllerKind::JointDampingLiteral, ControllerKind::Rns, ControllerKind::RnsDamped,
               ControllerKind::RnsHandback, ControllerKind::Detumble);
  const auto integrator =
      GENERATE(IntegratorKind::Rk4, IntegratorKind::Midpoint, IntegratorKind::Dopri5);
  for (const int n : {1, 3, 7, 16, 20}) {
    for (const bool has_sensors : {false, true}) {
      Random random(static_cast<std::uint64_t>(n), 5);
      RobotModel robot = random_robot(random, n, n == 3);
      for (Joint& joint : robot.joints) {
        joint.max_effort = 2;
        joint.max_velocity = 0.2;
        joint.rotor_inertia = 0.01;
        joint.coulomb_friction = 0.1;
        joint.viscous_friction = 0.2;
      }
      SimulationOptions options = brief_options(integrator);
      options.wheels.torque.setConstant(1);
      options.wheels.momentum.setConstant(5);
      if (has_sensors) {
        options.sensors = {.base_rate_error = 1e-3,
                           .joint_position_error = 1e-3,
                           .joint_rate_error = 1e-3,
                           .delay = 0.02};
        options.controller_robot = robot;
      }
      Controller controller = controller_with(kind);
      controller.friction_compensation = has_sensors;
      const auto runs = many_runs(robot, 11, random, options);
      const auto found = simulate_post_impacts(runs, controller);
      REQUIRE(found.size() == runs.size());
      for (std::size_t i = 0; i < runs.size(); ++i) {
        INFO("n " << n << ", run " << i << ", sensors " << has_sensors);
        check_same(found[i], single(runs[i], controller), 1e-9);
      }
    }
  }
}

TEST_CASE("a held target's grip is the same side by side", "[simulation]") {
  Random random(3, 5);
  const RobotModel robot = random_robot(random, 6, false);
  auto runs = many_runs(robot, 8, random, brief_options(IntegratorKind::Rk4));
  for (PostImpactRun& run : runs) {
    TargetBody body;
    body.mass = random.uniform(20, 40);
    body.inertia = Vector3d(3, 4, 5).asDiagonal();
    Eigen::Quaterniond turned;
    turned.coeffs() << random.normal(), random.unit_vector();
    const Pose hand_target{random.unit_vector(), turned.normalized()};
    run.robot = attach_target(run.robot, body, hand_target);
    run.options.grasp.target = HeldTarget{body, hand_target};
  }
  const Controller controller = controller_with(ControllerKind::RnsDamped);
  const auto found = simulate_post_impacts(runs, controller);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    CHECK(found[i].summary.peak_grip_force > 0.1);
    check_same(found[i], single(runs[i], controller), 1e-9);
  }
}

TEST_CASE("a run that meets a stop or ends early leaves its neighbours alone", "[simulation]") {
  Random random(4, 5);
  const RobotModel robot = random_robot(random, 5, false);
  auto runs = many_runs(robot, 8, random, brief_options(IntegratorKind::Midpoint));
  const Controller controller = controller_with(ControllerKind::RnsDamped);
  const auto undisturbed = simulate_post_impacts(runs, controller);
  auto disturbed = runs;
  // One begins against a stop that the others keep away from.
  double highest = -kInfinity;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    highest = std::max(highest, undisturbed[i].summary.highest_positions[2]);
  }
  for (PostImpactRun& run : disturbed) run.robot.joints[2].upper = highest + 0.05;
  disturbed[1].initial.phi[2] = highest + 0.04;
  disturbed[1].initial.phidot[2] = 1;
  disturbed[3].options.ends_when = [](const SimulationSummary& so_far) {
    return so_far.steps >= 0 && so_far.peak_joint_rate > 0;  // after the first step
  };
  const auto found = simulate_post_impacts(disturbed, controller);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    INFO("run " << i);
    check_same(found[i], single(disturbed[i], controller), 1e-9);
    if (i == 1 || i == 3) continue;
    CHECK(found[i].trace.back().state.phidot == undisturbed[i].trace.back().state.phidot);
    CHECK(found[i].summary.peak_torques == undisturbed[i].summary.peak_torques);
  }
  CHECK(found[1].summary.stop_hits > 0);
  CHECK(found[3].trace.back().time < 0.1);
}

TEST_CASE("a run leaves its lane as its controller and sensors are", "[simulation]") {
  Random random(8, 5);
  const RobotModel robot = random_robot(random, 6, false);
  SimulationOptions options = brief_options(IntegratorKind::Rk4);
  options.step = 0.003;  // several steps per control period
  options.sensors = {.base_rate_error = 1e-3, .joint_rate_error = 1e-3, .delay = 0.03};
  options.controller_robot = robot;
  options.horizon = 1;
  auto runs = many_runs(robot, 9, random, options);
  const Controller controller = controller_with(ControllerKind::RnsDamped);
  double highest = -kInfinity, lowest = kInfinity;
  for (const SimulationResult& run : simulate_post_impacts(runs, controller)) {
    highest = std::max(highest, run.summary.highest_positions[1]);
    lowest = std::min(lowest, run.summary.lowest_positions[4]);
  }
  // Where some of them go; one begins beyond its stop, one ends at its first.
  for (PostImpactRun& run : runs) {
    run.robot.joints[1].upper = highest - 0.1;
    run.robot.joints[4].lower = lowest + 0.1;
  }
  runs[2].initial.phi[1] = highest;
  runs[2].initial.phidot[1] = -0.3;
  for (const std::size_t i : {0, 2, 5}) {
    runs[i].options.ends_when = [](const SimulationSummary& so_far) {
      return so_far.stop_hits > 0 || so_far.attitude_turned > 0.05;
    };
  }
  const auto found = simulate_post_impacts(runs, controller);
  int hits = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    INFO("run " << i);
    check_same(found[i], single(runs[i], controller), 1e-9);
    hits += found[i].summary.stop_hits > 0;
  }
  CHECK(hits > 0);
  CHECK(hits < 9);
  // The limit of steps is that of the whole run.
  for (PostImpactRun& run : runs) run.options.max_steps = 250;
  for (const SimulationResult& run : simulate_post_impacts(runs, controller)) {
    CHECK(run.summary.steps <= 250);
  }
}

TEST_CASE("runs of different robots and controllers' models are told apart", "[simulation]") {
  Random random(9, 5);
  std::vector<PostImpactRun> runs;
  for (const int n : {3, 3, 5, 4, 4, 17, 3, 6, 6}) {
    RobotModel robot = random_robot(random, n, false);
    if (n == 6) robot = with_couplings(robot, random);
    const auto some = many_runs(robot, 2, random, brief_options(IntegratorKind::Rk4));
    runs.insert(runs.end(), some.begin(), some.end());
  }
  runs[1].options.controller_robot = runs[1].robot;
  runs[4].options.step = 0.005;
  runs[6].options.horizon = 0.2;
  runs[8].resistance.model = ResistanceModel::RotorInertia;
  runs[8].resistance.rotor_inertia = JointVectord::Constant(4, 0.3);
  runs[11].initial.base.orientation.coeffs() *= 1 + 5e-7;
  const Controller controller = controller_with(ControllerKind::JointDamping);
  const auto found = simulate_post_impacts(runs, controller);
  REQUIRE(found.size() == runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    INFO("run " << i);
    check_same(found[i], single(runs[i], controller), 1e-9);
  }
}

TEST_CASE("what becomes of a run does not depend on its neighbours", "[simulation]") {
  Random random(6, 5);
  const RobotModel robot = random_robot(random, 7, false);
  const auto runs = many_runs(robot, 13, random, brief_options(IntegratorKind::Rk4));
  const Controller controller = controller_with(ControllerKind::RnsDamped);
  const auto together = simulate_post_impacts(runs, controller);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto alone = simulate_post_impacts({runs[i]}, controller);
    CHECK(alone.front().trace.back().state.phidot == together[i].trace.back().state.phidot);
    CHECK(alone.front().summary.peak_base_rate == together[i].summary.peak_base_rate);
  }
  // Not even on one whose numbers grow beyond all bounds.
  auto wild = runs;
  wild[3].initial.phi[2] = 3e6;
  wild[3].initial.phidot *= 1e9;
  const auto beside = simulate_post_impacts(wild, controller);
  CHECK(beside[3].status == single(wild[3], controller).status);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (i == 3) continue;
    CHECK(beside[i].trace.back().state.phidot == together[i].trace.back().state.phidot);
  }
}

TEST_CASE("threads share runs out so that all are busy", "[simulation]") {
  const int lanes = size_of_group(1000, 1);
  CHECK(lanes >= 2);
  CHECK(size_of_group(10, 8) == 2);
  CHECK(size_of_group(3, 8) == 1);
  CHECK(size_of_group(0, 2) == 1);
  CHECK(size_of_group(1000, 2) == lanes);
}

TEST_CASE("runs side by side are refused and stopped as single ones", "[simulation]") {
  Random random(7, 5);
  const RobotModel robot = random_robot(random, 4, false);
  auto runs = many_runs(robot, 3, random, brief_options(IntegratorKind::Rk4));
  const Controller controller = controller_with(ControllerKind::JointDamping);
  const std::atomic<bool> interrupted = true;
  for (PostImpactRun& run : runs) run.options.stop.interrupted = &interrupted;
  for (const SimulationResult& result : simulate_post_impacts(runs, controller)) {
    CHECK(result.status == SimulationStatus::Interrupted);
  }
  for (PostImpactRun& run : runs) run.options.stop = {};
  for (PostImpactRun& run : runs) run.options.max_steps = 10;
  for (const SimulationResult& result : simulate_post_impacts(runs, controller)) {
    CHECK(result.status == SimulationStatus::StepLimit);
    CHECK(result.trace.back().time == Approx(0.1));
  }
  runs[1].initial.phi[0] = std::nan("");
  CHECK_THROWS_AS(simulate_post_impacts(runs, controller), InputError);
  CHECK(simulate_post_impacts({}, controller).empty());
}

}  // namespace stillbase::test
