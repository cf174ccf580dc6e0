// The motion before a contact with a hand that moves, by `reference`: the joint rates from the null
// space of the Jacobian, where the planner has multipliers.
#include <cmath>

#include <Eigen/Dense>

#include <stillbase/core/linear_algebra.hpp>

#include "verification/arrival.hpp"

namespace stillbase::verification {
namespace {

/// Of match_condition().
struct ArrivalOptions {
  /// Singular values that count, of the largest one: those that vanish round to 1e-15 of it.
  double rank = 1e-12;
};
constexpr ArrivalOptions kArrival;

Eigen::MatrixXd decided_jacobian(const reference::Dynamics& d, const DecidedVelocity& wanted) {
  return wanted.rows * hand_response(d);
}

}  // namespace

double DecidedVelocity::error(const Vector6d& hand) const {
  const Eigen::VectorXd apart = rows * hand - values;
  return apart.size() > 0 ? apart.cwiseAbs().maxCoeff() : 0;
}

DecidedVelocity decided_velocity(const CaptureProblem& problem, const ContactEvent& event,
                                 const Configuration& at) {
  const HandMotionSpec& hand = problem.hand_motion;
  const Matrix6d all = Matrix6d::Identity();
  Vector6d V;
  V << *event.velocity, event.omega;
  DecidedVelocity out;
  switch (hand.velocity) {
    case HandVelocity::Rest:
      break;
    case HandVelocity::MatchNormal:
      out.rows = event.n.transpose() * all.topRows(3);
      break;
    case HandVelocity::MatchLinear:
      out.rows = all.topRows(3);
      break;
    case HandVelocity::MatchAll:
      out.rows = all;
      break;
    case HandVelocity::Stated: {
      const Eigen::Quaterniond R_BT = at.base.orientation.conjugate() * event.R_NT;
      if (hand.linear) V.head<3>() -= R_BT * *hand.linear;
      if (hand.angular) V.tail<3>() -= R_BT * *hand.angular;
      const Eigen::Index first = hand.linear ? 0 : 3, last = hand.angular ? 6 : 3;
      out.rows = all.middleRows(first, last - first);
      break;
    }
  }
  out.values = out.rows * V;
  return out;
}

void PostureResponse::move(const Eigen::VectorXd& phidot) {
  const Eigen::Index n = phidot.size();
  MotionOfRobot motion;
  motion.phidot = phidot;
  motion.Omega = -reference::solve_definite(dynamics.H.topLeftCorner(6, 6),
                                            dynamics.H.topRightCorner(6, n) * phidot);
  Eigen::VectorXd x(6 + n);
  x << motion.Omega, phidot;
  motion.hand = dynamics.J * x;
  before = motion;
}

void move_hand(const CaptureProblem& problem, const ContactEvent& event, const Configuration& at,
               PostureResponse& response) {
  if (!problem.hand_motion.moves()) return;
  const reference::Dynamics& d = response.dynamics;
  const Eigen::Index n = d.H.cols() - 6;
  const DecidedVelocity wanted = decided_velocity(problem, event, at);
  const Eigen::MatrixXd G = decided_jacobian(d, wanted);
  const Svd svd = right_svd(G);
  const int rank = numerical_rank(svd.sigma, kArrival.rank);
  const Eigen::MatrixXd row_space = svd.V.leftCols(rank), free = svd.V.rightCols(n - rank);
  // Within the row space the equations have one solution.
  const Eigen::MatrixXd reduced = G * row_space;
  Eigen::VectorXd phidot = row_space * reduced.colPivHouseholderQr().solve(wanted.values);
  if (problem.hand_motion.rates == ArrivalRates::LeastBaseRate && free.cols() > 0) {
    const double weight = std::sqrt(kJointRateWeight);
    const Eigen::MatrixXd turning = base_response(d).bottomRows(3);
    Eigen::MatrixXd A(3 + n, free.cols());
    A << turning * free, weight * free;
    Eigen::VectorXd b(3 + n);
    b << turning * phidot, weight * phidot;
    phidot -= free * A.colPivHouseholderQr().solve(b);
  }
  response.move(phidot);
}

double match_condition(const Situation& at) {
  if (!at.problem.hand_motion.moves()) return 1;
  const DecidedVelocity wanted = decided_velocity(at.problem, at.event, at.at);
  const Eigen::VectorXd sigma = right_svd(decided_jacobian(at.response.dynamics, wanted)).sigma;
  const Eigen::Index last = wanted.rows.rows() - 1;
  return last < sigma.size() && sigma[0] > 0 ? sigma[last] / sigma[0] : 0;
}

void prepare_contact(const CaptureProblem& problem, const ContactEvent& event,
                     const Configuration& at, PostureResponse& response) {
  move_hand(problem, event, at, response);
  hold_latched(problem, event, response);
}

double arrival_rate_limit(const CaptureProblem& problem, int joint) {
  return problem.approach.velocity_scale *
         problem.robot.joints[static_cast<std::size_t>(joint)].max_velocity;
}

}  // namespace stillbase::verification
