// What free motion keeps, and how fast the integrators get it right.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <stillbase/simulation/simulate.hpp>
#include <utility>
#include <vector>

#include "simulation/robots.hpp"

namespace stillbase::test {
namespace {

SimulationOptions free_options(IntegratorKind integrator, double horizon) {
  SimulationOptions options;
  options.integrator = integrator;
  options.control_period = 0;
  options.horizon = horizon;
  options.output_period = 0;
  options.relative_tolerance = 1e-13;
  options.absolute_tolerance = 1e-13;
  return options;
}

SimulationResult run(const RobotModel& robot, const PlantState& state,
                     const SimulationOptions& options) {
  SimulationResult result = simulate_post_impact(robot, {}, state, Controller{}, options);
  REQUIRE(result.status == SimulationStatus::Finished);
  return result;
}

/// Distance of two states, all coordinates in SI units.
double distance(const PlantState& a, const PlantState& b) {
  return (a.base.position - b.base.position).norm() +
         a.base.orientation.angularDistance(b.base.orientation) + (a.phi - b.phi).norm() +
         (a.Omega - b.Omega).norm() + (a.phidot - b.phidot).norm();
}

/// Slope of log(error) over log(step) by least squares.
double order(const std::vector<double>& steps, const std::vector<double>& errors) {
  const auto count = static_cast<double>(steps.size());
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double a = std::log(steps[i]), b = std::log(errors[i]);
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  return (count * xy - x * y) / (count * xx - x * x);
}

}  // namespace

TEST_CASE("free motion of random trees keeps momentum in N and energy", "[simulation]") {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    Random random(seed, 7);
    const int n = 2 + static_cast<int>(seed % 6);
    const bool prismatic = seed % 2 == 1;
    const RobotModel robot = random_robot(random, n, prismatic);
    const PlantState state = random_state(random, n, prismatic ? 0.3 : 1.0);
    const SimulationResult result =
        run(robot, state, free_options(IntegratorKind::Fehlberg78, prismatic ? 3 : 10));
    const TraceSample &first = result.trace.front(), &last = result.trace.back();
    INFO("seed " << seed);
    CHECK(distance(first.state, last.state) > 0.5);
    CHECK((last.P_N - first.P_N).norm() < 1e-11 * first.P_N.norm());
    CHECK((last.total_N - first.total_N).norm() < 1e-11 * first.total_N.norm());
    CHECK(last.kinetic_energy == Approx(first.kinetic_energy).epsilon(1e-11));
    CHECK(result.summary.relative_momentum_drift < 1e-11);
    CHECK((last.base + last.coupling - last.total).norm() < 1e-12 * last.total.norm());
    CHECK(std::abs(last.state.base.orientation.norm() - 1) < 1e-15);
  }
}

TEST_CASE("angular momentum drifts by less than 1e-12 per second over 100 s", "[.slow]") {
  double largest = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed, 17);
    const int n = 2 + static_cast<int>(seed % 9);
    const RobotModel robot = random_robot(random, n, false);
    const PlantState state = random_state(random, n, 1.0);
    const SimulationResult result =
        run(robot, state, free_options(IntegratorKind::Fehlberg78, 100));
    const TraceSample &first = result.trace.front(), &last = result.trace.back();
    const double drift = (last.total_N - first.total_N).norm() / first.total_N.norm() / 100;
    INFO("seed " << seed << ", " << n << " joints");
    CHECK(drift <= 1e-12);
    largest = std::max(largest, drift);
  }
  WARN("largest drift of 20 trees: " << largest << " per second");
}

TEST_CASE("the system centroid moves on a straight line", "[simulation]") {
  Random random(3, 7);
  const RobotModel robot = random_robot(random, 5, true);
  const PlantState state = random_state(random, 5, 0.4);
  const SimulationResult result = run(robot, state, free_options(IntegratorKind::Dopri5, 2));
  const auto centroid = [&](const PlantState& s) {
    const Kinematics<double> kinematics = compute_kinematics(robot, s.phi);
    return Vector3d(s.base * compute_inertia(robot, kinematics).r_bg);
  };
  const TraceSample &first = result.trace.front(), &last = result.trace.back();
  const Vector3d moved = centroid(last.state) - centroid(first.state);
  const Vector3d expected = first.P_N / robot.total_mass() * (last.time - first.time);
  CHECK((moved - expected).norm() < 1e-11);
}

TEST_CASE("rotor inertia in the plant keeps momentum and energy, and changes the motion",
          "[simulation]") {
  Random random(5, 7);
  const RobotModel robot = random_robot(random, 4, false);
  const PlantState state = random_state(random, 4, 1);
  JointResistance rotors;
  rotors.model = ResistanceModel::RotorInertia;
  rotors.rotor_inertia = JointVectord::Constant(4, 0.7);
  const SimulationOptions options = free_options(IntegratorKind::Fehlberg78, 5);
  const SimulationResult with = simulate_post_impact(robot, rotors, state, Controller{}, options);
  const SimulationResult without = run(robot, state, options);
  CHECK(with.summary.relative_momentum_drift < 1e-11);
  CHECK(with.trace.back().kinetic_energy ==
        Approx(with.trace.front().kinetic_energy).epsilon(1e-11));
  CHECK(with.trace.front().kinetic_energy ==
        Approx(without.trace.front().kinetic_energy + 0.35 * state.phidot.squaredNorm()));
  CHECK(distance(with.trace.back().state, without.trace.back().state) > 0.1);
}

TEST_CASE("the fixed-step integrators have order 4 and 2, attitude and momentum drift included",
          "[simulation]") {
  const auto [kind, expected] =
      GENERATE(std::pair{IntegratorKind::Rk4, 4.0}, std::pair{IntegratorKind::Midpoint, 2.0});
  const std::vector<double> steps{0.04, 0.02, 0.01};
  for (std::uint64_t seed : {1, 2, 4}) {
    Random random(seed, 11);
    const RobotModel robot = random_robot(random, 5, seed == 4);
    const PlantState state = random_state(random, 5, 1);
    const PlantState exact =
        run(robot, state, free_options(IntegratorKind::Fehlberg78, 1)).trace.back().state;
    std::vector<double> errors, turns, drifts;
    for (const double step : steps) {
      SimulationOptions options = free_options(kind, 1);
      options.step = step;
      const SimulationResult result = run(robot, state, options);
      const PlantState& end = result.trace.back().state;
      errors.push_back(distance(end, exact));
      turns.push_back(end.base.orientation.angularDistance(exact.base.orientation));
      drifts.push_back((result.trace.back().total_N - result.trace.front().total_N).norm());
    }
    INFO("seed " << seed << ": errors " << errors.front() << " to " << errors.back() << ", drift "
                 << drifts.front() << " to " << drifts.back());
    CHECK(order(steps, errors) == Approx(expected).epsilon(0).margin(0.1));
    CHECK(order(steps, turns) == Approx(expected).epsilon(0).margin(0.1));
    CHECK(order(steps, drifts) == Approx(expected).epsilon(0).margin(0.1));
  }
}

TEST_CASE("fixed-step and both adaptive integrators agree", "[simulation]") {
  Random random(2, 13);
  const RobotModel robot = random_robot(random, 6, true);
  const PlantState state = random_state(random, 6, 0.3);
  SimulationOptions fixed = free_options(IntegratorKind::Rk4, 2);
  fixed.step = 1e-3;
  const PlantState a = run(robot, state, fixed).trace.back().state;
  const PlantState b =
      run(robot, state, free_options(IntegratorKind::Dopri5, 2)).trace.back().state;
  const PlantState c =
      run(robot, state, free_options(IntegratorKind::Fehlberg78, 2)).trace.back().state;
  CHECK(distance(a, b) < 1e-9);
  CHECK(distance(b, c) < 1e-10);
}

TEST_CASE("turning the whole scene changes nothing but the scene", "[simulation]") {
  Random random(8, 13);
  const RobotModel robot = random_robot(random, 4, false);
  const PlantState state = random_state(random, 4, 0.8);
  PlantState turned = state;
  const Pose scene{{1, -2, 3}, rotation_exp({0.4, -1.1, 0.7})};
  turned.base = scene * state.base;
  const SimulationOptions options = free_options(IntegratorKind::Rk4, 2);
  const PlantState a = run(robot, state, options).trace.back().state;
  const PlantState b = run(robot, turned, options).trace.back().state;
  PlantState expected = a;
  expected.base = scene * a.base;
  CHECK(distance(b, expected) < 1e-12);
}

TEST_CASE("a base wrench changes the momentum by its impulse", "[simulation]") {
  Random random(9, 13);
  const RobotModel robot = random_robot(random, 3, false);
  const PlantState state = random_state(random, 3, 0.4);
  const Vector3d force_N(1.5, -0.5, 2), torque_N(0.3, 0.2, -0.4);
  SimulationOptions options = free_options(IntegratorKind::Fehlberg78, 2);
  // A force through the system centroid and a torque, both fixed in N.
  options.base_wrench = [&](double, const PlantState& s) {
    const Kinematics<double> kinematics = compute_kinematics(robot, s.phi);
    const Vector3d g = compute_inertia(robot, kinematics).r_bg;
    const Eigen::Quaterniond to_B = s.base.orientation.conjugate();
    const Vector3d force = to_B * force_N;
    Vector6d wrench;
    wrench << force, g.cross(force) + to_B * torque_N;
    return wrench;
  };
  const SimulationResult result = run(robot, state, options);
  const TraceSample &first = result.trace.front(), &last = result.trace.back();
  CHECK((last.P_N - first.P_N - 2 * force_N).norm() < 1e-10);
  CHECK((last.total_N - first.total_N - 2 * torque_N).norm() < 1e-10);
}

}  // namespace stillbase::test
