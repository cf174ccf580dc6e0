// The plant against the second implementation of the dynamics.
#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <stillbase/reference/reference.hpp>
#include <stillbase/simulation/simulate.hpp>

#include "simulation/robots.hpp"
#include "support/coupled_robot.hpp"
#include "support/dense.hpp"
#include "support/drives.hpp"

namespace stillbase::test {

namespace {

/// (3) by the second implementation, with the rotors.
struct DenseEquation {
  Eigen::MatrixXd H;
  Eigen::VectorXd c;

  /// [dot Omega; phi''], zero for held joints.
  Eigen::VectorXd solved(const Vector6d& F_b, const JointVectord& tau,
                         const std::vector<bool>& held) const {
    Eigen::MatrixXd left = H;
    Eigen::VectorXd right(c.size());
    right << F_b, tau;
    right -= c;
    for (std::size_t k = 0; k < held.size(); ++k) {
      if (!held[k]) continue;
      const auto row = 6 + static_cast<Eigen::Index>(k);
      left.row(row).setZero();
      left.col(row).setZero();
      left(row, row) = 1;
      right[row] = 0;
    }
    return test::solve(left, right);
  }
};

DenseEquation dense_equation(const RobotModel& robot, const JointVectord& rotors,
                             const PlantState& state) {
  reference::Dynamics dynamics = reference::compute(robot, {state.phi, state.phidot, state.Omega});
  dynamics.H.diagonal().tail(robot.n()) += rotors;
  return {dynamics.H, dynamics.c};
}

}  // namespace

TEST_CASE("accelerations are those of the dense equation of motion", "[simulation]") {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Random random(seed, 37);
    const int n = 1 + static_cast<int>(seed % 8);
    const RobotModel robot = random_robot(random, n, seed % 2 == 0);
    const PlantState state = random_state(random, n, 1);
    const JointVectord rotors = JointVectord::Constant(n, random.uniform(0, 0.5));
    Vector6d F_b;
    F_b << random.unit_vector(), random.unit_vector();
    JointVectord tau(n);
    for (int k = 0; k < n; ++k) tau[k] = random.uniform(-1, 1);
    const PlantTerms terms(robot, rotors, state);
    const PlantAcceleration fast = compute_acceleration(terms, F_b, tau);

    const DenseEquation equation = dense_equation(robot, rotors, state);
    const Eigen::VectorXd dense = equation.solved(F_b, tau, {});
    INFO("seed " << seed);
    CHECK((fast.dot_Omega - dense.head(6)).norm() < 1e-10 * (1 + dense.norm()));
    CHECK((fast.phiddot - dense.tail(n)).norm() < 1e-10 * (1 + dense.norm()));

    Eigen::VectorXd velocity(6 + n);
    velocity << state.Omega, state.phidot;
    CHECK(kinetic_energy(terms.inertia, state) ==
          Approx(0.5 * velocity.dot(equation.H * velocity)));
  }
}

TEST_CASE("accelerations without the terms are those of the dense equation", "[simulation]") {
  for (int trial = 0; trial < 260; ++trial) {
    Random random(static_cast<std::uint64_t>(trial), 38);
    const int bodies = trial % (kMaxJoints + 1);
    RobotModel robot = with_drives(random_robot(random, bodies, trial % 3 != 0));
    if (trial % 7 == 6 && bodies > 1) robot = with_couplings(robot, random);
    const int n = robot.n();
    const PlantState state = random_state(random, n, 1);
    JointVectord rotors(n), tau(n);
    for (double& inertia : rotors) inertia = random.uniform(0, 0.5);
    for (double& torque : tau) torque = random.uniform(-1, 1);
    Vector6d F_b;
    F_b << random.unit_vector(), random.unit_vector();
    std::vector<bool> held(static_cast<std::size_t>(trial % 4 == 0 ? 0 : n));
    if (trial % 4 >= 2) {
      for (int k = 0; k < n; ++k)
        held[static_cast<std::size_t>(k)] = trial % 4 == 3 || random.uniform() < 0.4;
    }
    const auto moves = [&held](int k) {
      return held.empty() || !held[static_cast<std::size_t>(k)];
    };

    const Eigen::VectorXd dense = dense_equation(robot, rotors, state).solved(F_b, tau, held);
    const PlantAcceleration fast = compute_acceleration(robot, rotors, state, F_b, tau, held);
    INFO("trial " << trial << ", joints " << n);
    CHECK((fast.dot_Omega - dense.head(6)).norm() < 1e-9 * (1 + dense.norm()));
    CHECK((fast.phiddot - dense.tail(n)).norm() < 1e-9 * (1 + dense.norm()));
    for (int k = 0; k < n; ++k) CHECK((moves(k) || fast.phiddot[k] == 0));
  }
}

TEST_CASE("the trace's momenta are those of the second implementation", "[simulation]") {
  Random random(1, 41);
  const RobotModel robot = random_robot(random, 5, true);
  Controller controller;
  controller.kind = ControllerKind::RnsDamped;
  SimulationOptions options;
  options.horizon = 0.2;
  const SimulationResult result =
      simulate_post_impact(robot, {}, random_state(random, 5, 0.2), controller, options);
  REQUIRE(result.trace.size() == 21);
  for (const TraceSample& sample : result.trace) {
    const PlantState& s = sample.state;
    const reference::Dynamics dynamics = reference::compute(robot, {s.phi, s.phidot, s.Omega});
    CHECK((sample.total - dynamics.L_g).norm() < 1e-11);
    CHECK((sample.base - dynamics.Htilde_omega * s.Omega.tail<3>()).norm() < 1e-11);
    CHECK((sample.P_N - s.base.orientation * dynamics.P).norm() < 1e-11);
  }
}

TEST_CASE("a robot without joints is a free rigid body under every controller", "[simulation]") {
  RobotModel robot;
  robot.base = {"base", {}, 10, Vector3d::Zero(), Vector3d(1, 2, 2.5).asDiagonal()};
  PlantState state = state_at_rest(Pose(), JointVectord(0));
  state.Omega << 0.1, 0, 0.2, 0.3, 0.9, -0.2;
  for (const std::string& name : controller_names()) {
    Controller controller;
    controller.kind = *controller_from_name(name);
    SimulationOptions options;
    options.integrator = IntegratorKind::Fehlberg78;
    options.horizon = 2;
    options.output_period = 0;
    const SimulationResult result = simulate_post_impact(robot, {}, state, controller, options);
    INFO(name);
    REQUIRE(result.status == SimulationStatus::Finished);
    CHECK(result.summary.relative_momentum_drift < 1e-10);
    CHECK(result.trace.back().base.norm() == Approx(result.trace.front().base.norm()));
  }
}

}  // namespace stillbase::test
