// The free base's motion and the torques of a motion against the dense equation.
#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include <stillbase/reference/reference.hpp>

#include "dynamics/free_base.hpp"
#include "reference/random_state.hpp"
#include "support/coupled_robot.hpp"
#include "support/drives.hpp"

using namespace stillbase;
using namespace stillbase::reference_test;

TEST_CASE("a free base moves without momentum, and its torques are those of the dense equation") {
  for (int trial = 0; trial < 260; ++trial) {
    Random random(95, static_cast<std::uint64_t>(trial));
    const int bodies = 1 + trial % 25;  // some more than registers are used for
    RobotModel robot = with_drives(random_robot(random, bodies, trial % 3 != 0));
    if (trial % 7 == 6 && bodies > 1) robot = with_couplings(robot, random);
    const int n = robot.n();
    reference::State state = random_state(random, n);
    JointVectord phiddot(n);
    for (double& rate : phiddot) rate = random.uniform(-1, 1);
    INFO("trial " << trial << ", joints " << n);

    const bool base_moves = trial % 2 == 0;
    state.Omega.setZero();
    if (base_moves) {
      const Eigen::MatrixXd H = reference::compute(robot, state).H;
      const Vector6d dense = H.topLeftCorner<6, 6>().ldlt().solve(
          Vector6d(-H.topRightCorner(6, n) * Eigen::VectorXd(state.phidot)));
      state.Omega = free_base_velocity(robot, state.phi, state.phidot);
      CHECK((state.Omega - dense).norm() < 1e-11 * (1 + dense.norm()));
    }
    const reference::Dynamics dynamics = reference::compute(robot, state);
    Eigen::VectorXd rates(6 + n);
    rates << Vector6d::Zero(), phiddot;
    if (base_moves) {
      rates.head<6>() = dynamics.H.topLeftCorner<6, 6>().ldlt().solve(Vector6d(
          -dynamics.H.topRightCorner(6, n) * Eigen::VectorXd(phiddot) - dynamics.c.head<6>()));
    }
    const Eigen::VectorXd dense = (dynamics.H * rates + dynamics.c).tail(n);
    const JointVectord torques =
        motion_torques(robot, state.phi, state.phidot, phiddot, base_moves);
    CHECK((torques - dense).norm() < 1e-10 * (1 + dense.norm()));
  }
}
