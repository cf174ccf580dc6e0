#include "reference/control_laws.hpp"

#include <algorithm>
#include <cmath>

namespace stillbase::reference {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

Dynamics dynamics_of(const RobotModel& robot, const VectorXd& added_inertia, const State& state) {
  Dynamics d = compute(robot, state);
  if (added_inertia.size() != 0) d.H.diagonal().tail(added_inertia.size()) += added_inertia;
  return d;
}

Vector3d gyroscopic_moment(const Wheels& wheels, const Motion& motion) {
  if (!wheels.exist()) return Vector3d::Zero();
  return motion.wheel_momentum.cross(Vector3d(motion.state.Omega.tail<3>()));
}

namespace {

// A^d of command_of().
MatrixXd damped_inverse(const MatrixXd& A, double rank_edge, double least) {
  const Eigen::JacobiSVD<MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& sigma = svd.singularValues();
  if (sigma.size() == 0 || sigma(0) <= 0) return MatrixXd::Zero(A.cols(), A.rows());
  const double edge = std::max(rank_edge * sigma(0), least);
  VectorXd inverse(sigma.size());
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    inverse(i) = sigma(i) / std::pow(std::max(sigma(i), edge), 2);
  }
  return svd.matrixV() * inverse.asDiagonal() * svd.matrixU().transpose();
}

// Joint accelerations that a reaction null space law wants with the moment t_b on the base.
VectorXd wanted_acceleration(const ControlLaw& law, const Dynamics& d, const State& state,
                             const Vector3d& t_b) {
  const VectorXd& phidot = state.phidot;
  const MatrixXd& A = d.Htilde_omegaphi;
  const Vector3d omega = state.Omega.tail<3>();
  const Vector3d L_g = d.Htilde_omega * omega + A * phidot;
  // The translation eliminated: H is [w 1, *; *, *] in its first three rows.
  const MatrixXd lever = d.H.block(3, 0, 3, 3) / d.mass;
  const Vector3d ctilde = d.c.segment<3>(3) - lever * d.c.head<3>();
  const MatrixXd inverse = damped_inverse(A, law.rank_edge, L_g.norm() / law.joint_rate_edge);
  VectorXd w = -inverse * (ctilde - law.K_omega * d.Htilde_omega * omega - t_b);
  if (law.kind != ControlLaw::Kind::Rns) w -= law.K_phi * (phidot - inverse * (A * phidot));
  return w;
}

// [dot Omega; w] for joint accelerations w, with the moment t_b on the base.
VectorXd acceleration_with(const Dynamics& d, const VectorXd& w, const Vector3d& t_b) {
  const Eigen::Index n = w.size();
  VectorXd load = -(d.H.topRightCorner(6, n) * w + d.c.head<6>());
  load.tail<3>() += t_b;
  VectorXd out(6 + n);
  out << VectorXd(solve_definite(d.H.topLeftCorner(6, 6), load)), w;
  return out;
}

VectorXd torque_for(const Dynamics& d, const VectorXd& w, const Vector3d& t_b) {
  const Eigen::Index n = w.size();
  return d.H.bottomRows(n) * acceleration_with(d, w, t_b) + d.c.tail(n);
}

// What wheel i takes beyond what it holds, of a momentum with the sign of `towards`; zero when
// full.
double room_of(const Wheels& wheels, const Vector3d& held, int i, double towards) {
  constexpr double kFull = 1 - 1e-9;
  const double filled = towards < 0 ? -held(i) : held(i);
  return filled < kFull * wheels.capacity(i) ? wheels.capacity(i) - filled : 0;
}

// u, no more than fills a wheel within a period; it takes the opposite.
Vector3d within_room(const Wheels& wheels, const Vector3d& held, Vector3d u, double period) {
  for (int i = 0; i < 3 && period > 0; ++i) {
    const double size = std::min(std::abs(u(i)), room_of(wheels, held, i, -u(i)) / period);
    u(i) = std::copysign(size, u(i));
  }
  return u;
}

Vector3d handback_moment(const ControlLaw& law, const Wheels& wheels, const Vector3d& L_g,
                         const Vector3d& held) {
  Vector3d u = -law.K_handback * L_g;
  double excess = 1;
  for (int i = 0; i < 3; ++i) {
    if (wheels.torque(i) <= 0 || room_of(wheels, held, i, L_g(i)) <= 0) {
      u(i) = 0;
    } else {
      excess = std::max(excess, std::abs(u(i)) / wheels.torque(i));
    }
  }
  return within_room(wheels, held, u / excess, law.period);
}

Vector3d detumbling_moment(const ControlLaw& law, const Wheels& wheels, Vector3d L_g,
                           const Vector3d& held) {
  double time = std::max(1 / law.K_detumble, 2 * law.period);
  for (int i = 0; i < 3; ++i) {
    if (wheels.torque(i) <= 0 || room_of(wheels, held, i, L_g(i)) <= 0) {
      L_g(i) = 0;
    } else {
      time = std::max(time, std::abs(L_g(i)) / wheels.torque(i));
    }
  }
  return within_room(wheels, held, -L_g / time, law.period);
}

// The most of s in [0, 1] with |from + s (to - from)| <= max(most, |from|), by bisection: the norm
// is convex in s.
double part_within(const VectorXd& from, const VectorXd& to, double most) {
  const double bound = std::max(most, from.norm());
  if (to.norm() <= bound) return 1;
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (VectorXd(from + middle * (to - from)).norm() <= bound ? low : high) = middle;
  }
  return low;
}

// The law Detumble at one state.
class Detumbling {
 public:
  Detumbling(const ControlledRobot& subject, const ControlLaw& law, const Motion& motion,
             const Dynamics& d)
      : subject_(subject), law_(law), d_(d) {
    if (subject.known_empty != nullptr) {
      empty_ = dynamics_of(*subject.known_empty, subject.added_inertia, motion.state);
    }
    const Vector3d t_b = gyroscopic_moment(subject.wheels, motion);
    const VectorXd still = VectorXd::Zero(motion.state.phi.size());
    const VectorXd braking = -law.K_phi * motion.state.phidot;
    const VectorXd w = part(still, t_b, braking, t_b) * braking;
    if (subject.wheels.exist()) {
      const Vector3d u = detumbling_moment(law, subject.wheels, d.L_g, motion.wheel_momentum);
      command_.wheels = part(w, t_b, w, t_b + u) * u;
    }
    command_.tau = torque_for(d, w, t_b + command_.wheels);
  }

  const Command& command() const { return command_; }

 private:
  // Wrench on the held target at the hand: what the equations of motion with it have more than
  // those without. The base's rows are [f; r x f + t].
  Eigen::Matrix<double, 6, 1> grip_load(const VectorXd& acceleration) const {
    const Eigen::Matrix<double, 6, 1> rows =
        (d_.H - empty_->H).topRows(6) * acceleration + (d_.c - empty_->c).head(6);
    Eigen::Matrix<double, 6, 1> wrench = rows;
    wrench.tail<3>() -= d_.hand_position.cross(Vector3d(rows.head<3>()));
    return wrench;
  }

  double part(const VectorXd& w_from, const Vector3d& t_from, const VectorXd& w_to,
              const Vector3d& t_to) const {
    const double kept = 1 - law_.reserve;
    const VectorXd tau_from = torque_for(d_, w_from, t_from), tau_to = torque_for(d_, w_to, t_to);
    double least = 1;
    for (int k = 0; k < subject_.known.n(); ++k) {
      least = std::min(least, part_within(tau_from.segment(k, 1), tau_to.segment(k, 1),
                                          kept * subject_.known.joints[k].max_effort));
    }
    if (!empty_) return least;
    const auto load_from = grip_load(acceleration_with(d_, w_from, t_from));
    const auto load_to = grip_load(acceleration_with(d_, w_to, t_to));
    return std::min(
        {least, part_within(load_from.head<3>(), load_to.head<3>(), kept * subject_.grip_force),
         part_within(load_from.tail<3>(), load_to.tail<3>(), kept * subject_.grip_moment)});
  }

  const ControlledRobot& subject_;
  const ControlLaw& law_;
  const Dynamics& d_;
  std::optional<Dynamics> empty_;
  Command command_;
};

// Torque against the friction that a law knows of.
VectorXd compensated_friction(const RobotModel& known, double rate, const VectorXd& phidot) {
  VectorXd tau(phidot.size());
  for (int k = 0; k < known.n(); ++k) {
    const Joint& joint = known.joints[k];
    tau(k) =
        joint.viscous_friction * phidot(k) + joint.coulomb_friction * std::tanh(phidot(k) / rate);
  }
  return tau;
}

Vector3d thruster_moment(const Thrusters& thrusters, const Dynamics& d, const Vector3d& omega) {
  if (thrusters.torque <= 0 || omega.norm() < thrusters.dead_band) return Vector3d::Zero();
  Vector3d moment = -thrusters.gain * d.Htilde_omega * omega;
  for (double& m : moment) m = std::clamp(m, -thrusters.torque, thrusters.torque);
  return moment;
}

}  // namespace

RobotModel holding(RobotModel robot, const MetBody& body) {
  if (body.mass <= 0) return robot;
  Body& carrier = robot.hand_body == kBase
                      ? robot.base
                      : robot.bodies[static_cast<std::size_t>(robot.hand_body)];
  const Vector3d place = robot.p_hand - robot.R_hand * body.r;  // of the body's centroid
  const double mass = carrier.mass + body.mass;
  const Vector3d apart = place - carrier.centroid;
  const Eigen::Matrix3d arm =
      apart.squaredNorm() * Eigen::Matrix3d::Identity() - apart * apart.transpose();
  carrier.inertia += robot.R_hand * body.inertia * robot.R_hand.transpose() +
                     carrier.mass * body.mass / mass * arm;
  carrier.centroid += body.mass / mass * apart;
  carrier.mass = mass;
  return robot;
}

Command command_of(const ControlledRobot& subject, const ControlLaw& law, const Motion& motion,
                   double time) {
  using Kind = ControlLaw::Kind;
  const State& state = motion.state;
  const Wheels& wheels = subject.wheels;
  const VectorXd still = VectorXd::Zero(state.phi.size());
  const Dynamics d = dynamics_of(subject.known, subject.added_inertia, state);
  Command out;
  if (law.kind == Kind::Free) {
    out.tau = still;
  } else if (law.kind == Kind::Detumble) {
    out = Detumbling(subject, law, motion, d).command();
  } else {
    Vector3d t_b = gyroscopic_moment(wheels, motion);
    if (law.kind == Kind::RnsHandback && wheels.exist() && time >= law.handback_start) {
      out.wheels = handback_moment(law, wheels, d.L_g, motion.wheel_momentum);
      t_b += out.wheels;
    }
    if (law.kind == Kind::JointDampingLiteral) {
      out.tau = torque_for(d, still, Vector3d::Zero()) - law.K_phi * state.phidot;
    } else if (law.kind == Kind::JointDamping) {
      out.tau = torque_for(d, -law.K_phi * state.phidot, t_b);
    } else {
      out.tau = torque_for(d, wanted_acceleration(law, d, state, t_b), t_b);
    }
  }
  if (law.friction_rate > 0 && law.kind != Kind::Free) {
    out.tau += compensated_friction(subject.known, law.friction_rate, state.phidot);
  }
  out.thrusters = thruster_moment(subject.thrusters, d, state.Omega.tail<3>());
  return out;
}

}  // namespace stillbase::reference
