// Two routes to the same motion: articulated bodies against the inertia matrix.
#include <catch2/catch.hpp>

#include <stillbase/dynamics/articulated_body.hpp>
#include <stillbase/impact/jump.hpp>

#include "reference/random_state.hpp"

using namespace stillbase;
using namespace stillbase::reference_test;

namespace {

struct Case {
  RobotModel robot;
  JointVectord phi, phidot, added;
  Vector6d Omega;
  std::vector<bool> locked;
};

/// Trees and chains with 2 to 60 joints; joints free, with added inertia, some or all locked.
Case random_case(int trial) {
  Random random(43, static_cast<std::uint64_t>(trial));
  const int n = 2 + random.index(59);
  Case out;
  out.robot = random_robot(random, n, trial % 4 != 0);
  const reference::State state = random_state(random, n);
  out.phi = state.phi;
  out.phidot = state.phidot;
  out.Omega = state.Omega;
  out.added = JointVectord::Zero(n);
  for (int k = 0; k < n; ++k) {
    if (trial % 5 == 1) out.added[k] = random.uniform(0, 2);
    if (trial % 5 >= 2) out.locked.push_back(trial % 5 == 4 || random.uniform() < 0.4);
  }
  return out;
}

/// Difference relative to the second motion; rates and base twist are of one size here.
double difference(const GeneralizedMotion<double>& a, const GeneralizedMotion<double>& b) {
  return ((a.Omega - b.Omega).norm() + (a.phidot - b.phidot).norm()) /
         (b.Omega.norm() + b.phidot.norm());
}

}  // namespace

TEST_CASE("articulated bodies and the inertia matrix give the same motion on random trees") {
  double worst_solve = 0, worst_acceleration = 0, worst_jump = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Case c = random_case(trial);
    const auto kinematics = compute_kinematics<double>(c.robot, c.phi);
    const auto inertia = compute_inertia(c.robot, kinematics);
    const auto jacobian = compute_hand_jacobian(c.robot, kinematics);
    const auto factor = factorize_inertia(inertia, c.added, c.locked);
    const auto bodies = factorize_articulated_bodies(c.robot, kinematics, c.added, c.locked);

    const auto solved = solve_articulated_bodies<double>(c.robot, bodies, c.Omega, c.phidot);
    const auto solved_matrix = solve_inertia<double>(factor, c.Omega, c.phidot);
    worst_solve = std::max(worst_solve, difference(solved, solved_matrix));

    const auto bias = compute_bias<double>(c.robot, kinematics, inertia, c.Omega, c.phidot);
    const auto moved = articulated_acceleration<double>(c.robot, kinematics, bodies, c.Omega,
                                                        c.phidot, c.Omega, c.phidot);
    const auto moved_matrix = solve_inertia<double>(factor, Vector6d(c.Omega - bias.c_b),
                                                    JointVectord(c.phidot - bias.c_phi));
    worst_acceleration = std::max(worst_acceleration, difference(moved, moved_matrix));

    const auto jump = compute_jump<double>(c.robot, c.phi, c.added, c.locked, c.Omega);
    const auto by_matrix = compute_jump<double>(factor, jacobian, c.Omega);
    worst_jump = std::max(worst_jump, difference({jump.Delta_Omega, jump.Delta_phidot},
                                                 {by_matrix.Delta_Omega, by_matrix.Delta_phidot}));
  }
  // Conditions of the inertia matrices reach 1e6.
  CHECK(worst_solve < 1e-10);
  CHECK(worst_acceleration < 1e-10);
  CHECK(worst_jump < 1e-10);
}

TEST_CASE("a robot with all joints locked moves as one rigid body") {
  Random random(44);
  const RobotModel robot = random_robot(random, 30, true);
  const auto kinematics = compute_kinematics<double>(robot, JointVectord::Constant(30, 0.2));
  const auto bodies = factorize_articulated_bodies<double>(
      robot, kinematics, JointVectord::Zero(30), std::vector<bool>(30, true));
  const Vector6d F = Vector6d::LinSpaced(-1, 1);
  const auto motion =
      solve_articulated_bodies<double>(robot, bodies, F, JointVectord::Constant(30, 5));
  CHECK(motion.phidot.norm() == 0);
  const Vector6d momentum = compute_inertia(robot, kinematics).H_b * motion.Omega;
  CHECK((momentum - F).norm() < 1e-12);
}
