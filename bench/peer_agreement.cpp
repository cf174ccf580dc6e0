#include <stdexcept>

#include <Eigen/Cholesky>

#include <stillbase/dynamics/bias.hpp>

#include "bench_support.hpp"
#include "simulation/integrators.hpp"

namespace stillbase {

namespace {

void require_near(const std::string& what, const Eigen::MatrixXd& theirs,
                  const Eigen::MatrixXd& ours) {
  const double difference = (theirs - ours).norm() / ours.norm();
  if (!(difference < 1e-9)) {
    throw std::runtime_error(what + " differs from ours by " + std::to_string(difference) +
                             " of its size: not the same robot, so no comparison");
  }
}

}  // namespace

void require_agreement(const std::string& peer, const JointVectord& phi,
                       const PeerAnswers& answers) {
  const int n = robot().n();
  const auto kinematics = compute_kinematics<double>(robot(), phi);
  const auto inertia = compute_inertia(robot(), kinematics);
  const auto jacobian = compute_hand_jacobian(robot(), kinematics);
  const auto bias =
      compute_bias<double>(robot(), kinematics, inertia, Vector6d::Zero(), joint_rates());
  Eigen::MatrixXd H(6 + n, 6 + n);
  H << inertia.H_b, inertia.H_bphi, inertia.H_bphi.transpose(), inertia.H_phi;
  Eigen::VectorXd impulse(6 + n), c(6 + n);
  impulse << jacobian.R_bh.transpose() * wrench(), jacobian.J_phi.transpose() * wrench();
  c << bias.c_b, bias.c_phi;
  require_near(peer + ": mass matrix", answers.H, H);
  require_near(peer + ": jump", answers.jump, H.llt().solve(impulse));
  require_near(peer + ": acceleration", answers.acceleration, H.llt().solve(-c));
  if (answers.step.size() == 0) return;
  const SimulationOptions options;
  const Controller controller;
  const JointVectord no_rotors = JointVectord::Zero(n);
  ClosedLoop loop(robot(), no_rotors, controller, options);
  StateVector x = pack(moving_arm());
  rk4_step(loop, 0, kStep, x, nullptr);
  const PlantState state = unpack(x, n);
  Eigen::VectorXd step(2 * n + 3);
  step << state.phi, state.phidot, state.Omega.tail<3>();
  require_near(peer + ": step", answers.step, step);
}

}  // namespace stillbase
