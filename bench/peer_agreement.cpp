#include <stdexcept>

#include <Eigen/Cholesky>

#include <stillbase/dynamics/bias.hpp>

#include "bench_support.hpp"

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
}

}  // namespace stillbase
