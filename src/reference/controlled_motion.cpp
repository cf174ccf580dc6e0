#include "reference/controlled_motion.hpp"

#include <algorithm>
#include <cmath>

namespace stillbase::reference {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// H with the added inertia on the joints' diagonal.
Dynamics dynamics_of(const RobotModel& robot, const VectorXd& added_inertia, const State& state) {
  Dynamics d = compute(robot, state);
  if (added_inertia.size() != 0) d.H.diagonal().tail(added_inertia.size()) += added_inertia;
  return d;
}

// A^d of control_torque().
MatrixXd damped_inverse(const MatrixXd& A, double rank_edge, double least) {
  const Eigen::JacobiSVD<MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd sigma = svd.singularValues();
  if (sigma.size() == 0 || sigma(0) <= 0) return MatrixXd::Zero(A.cols(), A.rows());
  const double edge = std::max(rank_edge * sigma(0), least);
  VectorXd inverse(sigma.size());
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    inverse(i) = sigma(i) / std::pow(std::max(sigma(i), edge), 2);
  }
  return svd.matrixV() * inverse.asDiagonal() * svd.matrixU().transpose();
}

// u of control_torque().
VectorXd wanted_acceleration(const ControlLaw& law, const Dynamics& d, const State& state) {
  const VectorXd& phidot = state.phidot;
  if (law.kind == ControlLaw::Kind::JointDamping) return -law.K_phi * phidot;
  const MatrixXd& A = d.Htilde_omegaphi;
  const Vector3d omega = state.Omega.tail<3>();
  const Vector3d L_g = d.Htilde_omega * omega + A * phidot;
  // The translation eliminated: H is [w 1, *; *, *] in its first three rows.
  const MatrixXd lever = d.H.block(3, 0, 3, 3) / d.mass;
  const Vector3d ctilde = d.c.segment<3>(3) - lever * d.c.head<3>();
  const MatrixXd inverse = damped_inverse(A, law.rank_edge, L_g.norm() / law.joint_rate_edge);
  VectorXd u = -inverse * (ctilde - law.K_omega * d.Htilde_omega * omega);
  if (law.kind == ControlLaw::Kind::RnsDamped) u -= law.K_phi * (phidot - inverse * (A * phidot));
  return u;
}

// Torques for joint accelerations u, without wrenches on base and hand.
VectorXd torque_for(const Dynamics& d, const VectorXd& u) {
  const Eigen::Index n = u.size();
  const VectorXd base_load = -(d.H.topRightCorner(6, n) * u + d.c.head<6>());
  const VectorXd base = solve_definite(d.H.topLeftCorner(6, 6), base_load);
  return d.H.bottomLeftCorner(n, 6) * base + d.H.bottomRightCorner(n, n) * u + d.c.tail(n);
}

// The part of the torques that the drives give.
VectorXd limited(const RobotModel& robot, const VectorXd& demanded, const VectorXd& phidot) {
  VectorXd tau = demanded;
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[k];
    if (std::abs(phidot(k)) >= joint.max_velocity && tau(k) * phidot(k) > 0) tau(k) = 0;
    tau(k) = std::clamp(tau(k), -joint.max_effort, joint.max_effort);
  }
  return tau;
}

// [position; quaternion x, y, z, w; phi; Omega; phidot].
VectorXd packed(const Motion& motion) {
  VectorXd x(13 + 2 * motion.state.phi.size());
  x << motion.base.position, motion.base.orientation.coeffs(), motion.state.phi, motion.state.Omega,
      motion.state.phidot;
  return x;
}

Motion unpacked(const VectorXd& x) {
  const Eigen::Index n = (x.size() - 13) / 2;
  Motion motion;
  motion.base.position = x.head<3>();
  motion.base.orientation.coeffs() = x.segment<4>(3).normalized();
  motion.state.phi = x.segment(7, n);
  motion.state.Omega = x.segment<6>(7 + n);
  motion.state.phidot = x.tail(n);
  return motion;
}

class Run {
 public:
  Run(const ControlledRobot& subject, const ControlLaw& law, double tolerance)
      : subject_(subject), law_(law), tolerance_(tolerance) {}

  void command(const State& state) {
    const VectorXd demanded = control_torque(subject_, law_, state);
    if (peaks_.size() == 0) peaks_ = VectorXd::Zero(demanded.size());
    peaks_ = peaks_.cwiseMax(demanded.cwiseAbs());
    held_ = limited(subject_.robot, demanded, state.phidot);
  }

  // Moves x from t to `end` with the torques held, or with those of every instant.
  bool advance(VectorXd& x, double t, double end, const StopCondition& stop) {
    while (t < end) {
      if (stop.reached()) return false;
      const bool is_last = step_ >= end - t;
      const double h = is_last ? end - t : step_;
      VectorXd next;
      const double error = try_step(x, h, next) / tolerance_;
      if (!std::isfinite(error) && h < 1e-9) return false;
      const double factor =
          std::isfinite(error) ? std::clamp(0.9 * std::pow(error, -0.2), 0.2, 5.0) : 0.1;
      if (error <= 1) {
        x = next;
        x.segment<4>(3).normalize();
        t = is_last ? end : t + h;
        if (!is_last || factor < 1) step_ = h * factor;
      } else {
        step_ = h * factor;
        if (step_ < 1e-12) return false;
      }
    }
    return true;
  }

  const VectorXd& peaks() const { return peaks_; }

 private:
  VectorXd rate(const VectorXd& x) {
    const Motion motion = unpacked(x);
    const State& state = motion.state;
    if (law_.period <= 0) command(state);
    const Eigen::Index n = state.phi.size();
    const Dynamics d = dynamics_of(subject_.robot, subject_.added_inertia, state);
    VectorXd load = -d.c;
    load.tail(n) += held_;
    const VectorXd acceleration = solve_definite(d.H, load);
    const Vector3d half = state.Omega.tail<3>() / 2;
    const Eigen::Quaterniond q(x(6), x(3), x(4), x(5));
    const Eigen::Quaterniond spin(0, half.x(), half.y(), half.z());
    VectorXd out(x.size());
    out << motion.base.orientation * Vector3d(state.Omega.head<3>()), (q * spin).coeffs(),
        state.phidot, acceleration;
    return out;
  }

  // One step by Dormand and Prince; the error of the fourth-order solution over 1 + |x|.
  double try_step(const VectorXd& x, double h, VectorXd& next) {
    const VectorXd k1 = rate(x);
    const VectorXd k2 = rate(x + h * (1. / 5 * k1));
    const VectorXd k3 = rate(x + h * (3. / 40 * k1 + 9. / 40 * k2));
    const VectorXd k4 = rate(x + h * (44. / 45 * k1 - 56. / 15 * k2 + 32. / 9 * k3));
    const VectorXd k5 = rate(
        x + h * (19372. / 6561 * k1 - 25360. / 2187 * k2 + 64448. / 6561 * k3 - 212. / 729 * k4));
    const VectorXd k6 = rate(x + h * (9017. / 3168 * k1 - 355. / 33 * k2 + 46732. / 5247 * k3 +
                                      49. / 176 * k4 - 5103. / 18656 * k5));
    next = x + h * (35. / 384 * k1 + 500. / 1113 * k3 + 125. / 192 * k4 - 2187. / 6784 * k5 +
                    11. / 84 * k6);
    const VectorXd k7 = rate(next);
    const VectorXd error = h * (71. / 57600 * k1 - 71. / 16695 * k3 + 71. / 1920 * k4 -
                                17253. / 339200 * k5 + 22. / 525 * k6 - 1. / 40 * k7);
    return (error.array() / (1 + x.array().abs())).abs().maxCoeff();
  }

  const ControlledRobot& subject_;
  const ControlLaw& law_;
  double tolerance_;
  double step_ = 0.01;
  VectorXd held_;
  VectorXd peaks_;
};

}  // namespace

VectorXd control_torque(const ControlledRobot& subject, const ControlLaw& law, const State& state) {
  const Eigen::Index n = state.phi.size();
  if (law.kind == ControlLaw::Kind::Free) return VectorXd::Zero(n);
  const Dynamics d = dynamics_of(subject.known, subject.added_inertia, state);
  if (law.kind == ControlLaw::Kind::JointDampingLiteral) {
    return torque_for(d, VectorXd::Zero(n)) - law.K_phi * state.phidot;
  }
  return torque_for(d, wanted_acceleration(law, d, state));
}

ControlledMotion controlled_motion(const ControlledRobot& subject, const ControlLaw& law,
                                   const Motion& start, const std::vector<double>& times,
                                   double tolerance, const StopCondition& stop) {
  ControlledMotion out;
  Run run(subject, law, tolerance);
  VectorXd x = packed(start);
  double t = 0;
  long commands = 0;
  if (law.period <= 0) run.command(start.state);
  for (const double time : times) {
    while (true) {
      const double next = static_cast<double>(commands) * law.period;
      const bool commands_first = law.period > 0 && next < time * (1 - 1e-12);
      const double end = commands_first ? next : time;
      if (!run.advance(x, t, end, stop)) return out;
      t = end;
      if (!commands_first) break;
      run.command(unpacked(x).state);
      ++commands;
    }
    out.samples.push_back(unpacked(x));
  }
  out.peak_demanded_torques = run.peaks();
  out.complete = true;
  return out;
}

}  // namespace stillbase::reference
