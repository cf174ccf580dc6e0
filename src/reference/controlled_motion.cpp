#include "reference/controlled_motion.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/random.hpp>

#include "core/normal_pairs.hpp"
#include "reference/resting_joints.hpp"

namespace stillbase::reference {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

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

constexpr Eigen::Index kBodySize = 13;

// [position; quaternion x, y, z, w; phi; Omega; phidot; h_w], and of a target [position;
// quaternion; velocity; rate].
VectorXd packed(const Motion& motion) {
  const Eigen::Index own = 16 + 2 * motion.state.phi.size();
  VectorXd x(own + (motion.target ? kBodySize : 0));
  x.head(own) << motion.base.position, motion.base.orientation.coeffs(), motion.state.phi,
      motion.state.Omega, motion.state.phidot, motion.wheel_momentum;
  if (motion.target) {
    x.tail<kBodySize>() << motion.target->pose.position, motion.target->pose.orientation.coeffs(),
        motion.target->velocity, motion.target->rate;
  }
  return x;
}

// Derivative of a unit quaternion's coefficients, of a frame that turns at `rate` in its own axes.
Eigen::Vector4d quaternion_rate(const Eigen::Vector4d& coefficients, const Vector3d& rate) {
  const Eigen::Quaterniond q(coefficients);
  const Eigen::Quaterniond spin(0, rate.x() / 2, rate.y() / 2, rate.z() / 2);
  return (q * spin).coeffs();
}

// @param n joints
Motion unpacked(const VectorXd& x, Eigen::Index n) {
  Motion motion;
  motion.base.position = x.head<3>();
  motion.base.orientation.coeffs() = x.segment<4>(3).normalized();
  motion.state.phi = x.segment(7, n);
  motion.state.Omega = x.segment<6>(7 + n);
  motion.state.phidot = x.segment(13 + n, n);
  motion.wheel_momentum = x.segment<3>(13 + 2 * n);
  if (x.size() == 16 + 2 * n) return motion;
  motion.target.emplace();
  motion.target->pose.position = x.tail<kBodySize>().head<3>();
  motion.target->pose.orientation.coeffs() = x.tail<kBodySize>().segment<4>(3).normalized();
  motion.target->velocity = x.tail<6>().head<3>();
  motion.target->rate = x.tail<3>();
  return motion;
}

// What keeps a joint where it is, or works against it.
struct JointHold {
  bool rests = false;
  int stop = 0;    // -1: at the lower one, 1: at the upper one
  int slides = 0;  // sign of the rate that Coulomb friction works against
};

class Run {
 public:
  Run(const ControlledRobot& subject, const ControlLaw& law, double tolerance)
      : subject_(subject),
        law_(law),
        tolerance_(tolerance),
        holds_(static_cast<std::size_t>(subject.robot.n())) {
    if (subject.sensors) random_.emplace(subject.sensors->seed, subject.sensors->stream);
  }

  Motion motion_of(const VectorXd& x) const { return unpacked(x, subject_.robot.n()); }
  bool has_two_at_stops() const { return has_two_at_stops_; }

  void command(const Motion& motion, double time) {
    held_ = command_of(subject_, law_, subject_.sensors ? measured(motion) : motion, time);
    if (peaks_.size() == 0) peaks_ = VectorXd::Zero(held_.tau.size());
    peaks_ = peaks_.cwiseMax(held_.tau.cwiseAbs());
    wheel_peaks_ = wheel_peaks_.cwiseMax(held_.wheels.cwiseAbs());
    held_.tau = limited(subject_.robot, held_.tau, motion.state.phidot);
  }

  // Moves x from t to `end` with the torques held, or with those of every instant.
  bool advance(VectorXd& x, double t, double end, const StopCondition& stop) {
    if (t >= end) return true;  // before the first command
    if (!make_switches(x, t)) return false;
    while (t < end) {
      if (stop.reached()) return false;
      const bool is_last = step_ >= end - t;
      const double h = is_last ? end - t : step_;
      VectorXd next;
      const double error = try_step(x, t, h, next) / tolerance_;
      if (!std::isfinite(error) && h < 1e-9) return false;
      const double factor =
          std::isfinite(error) ? std::clamp(0.9 * std::pow(error, -0.2), 0.2, 5.0) : 0.1;
      if (error <= 1) {
        normalise(next);
        if (switches(next, t + h)) {
          t += cut_at_switch(x, t, h, next);
          if (!make_switches(next, t)) return false;
        } else {
          t = is_last ? end : t + h;
        }
        x = next;
        if (!is_last || factor < 1) step_ = h * factor;
      } else {
        step_ = h * factor;
        if (step_ < 1e-12) return false;
      }
    }
    return true;
  }

  const VectorXd& peaks() const { return peaks_; }
  const Vector3d& wheel_peaks() const { return wheel_peaks_; }

 private:
  // What the sensors say.
  Motion measured(const Motion& motion) {
    const Sensors& sensors = *subject_.sensors;
    Motion told = motion;
    add_normals(*random_, sensors.base_rate_error, told.state.Omega.tail<3>());
    add_normals(*random_, sensors.joint_position_error, told.state.phi);
    add_normals(*random_, sensors.joint_rate_error, told.state.phidot);
    told_.push_back(told);
    return told_[told_.size() - 1 - std::min(told_.size() - 1, sensors.delay)];
  }

  // X of H x = load with x zero for some joints, whose rows do not count.
  static VectorXd solve_but_for(const std::vector<bool>& joints, MatrixXd H, VectorXd load) {
    for (std::size_t k = 0; k < joints.size(); ++k) {
      if (!joints[k]) continue;
      const auto i = static_cast<Eigen::Index>(6 + k);
      H.row(i).setZero();
      H.col(i).setZero();
      H(i, i) = 1;
      load(i) = 0;
    }
    return solve_definite(H, load);
  }

  void normalise(VectorXd& x) const {
    x.segment<4>(3).normalize();
    if (subject_.contact) x.tail<kBodySize>().segment<4>(3).normalize();
  }

  double coulomb(int k) const {
    return subject_.has_friction ? subject_.robot.joints[k].coulomb_friction : 0;
  }

  // Matrix and load of the equations of motion, friction and stops of joints at rest left out.
  struct Equations {
    Motion motion;
    Dynamics d;
    VectorXd load;
    ContactPush contact;
  };
  Equations equations(const VectorXd& x, double time) {
    Equations out{motion_of(x), {}, {}, {}};
    const Motion& motion = out.motion;
    const State& state = motion.state;
    if (law_.period <= 0) command(motion, time);
    out.d = dynamics_of(subject_.robot, subject_.added_inertia, state);
    VectorXd& load = out.load;
    load = -out.d.c;
    load.segment<3>(3) +=
        held_.wheels + held_.thrusters + gyroscopic_moment(subject_.wheels, motion);
    load.tail(state.phi.size()) += held_.tau;
    for (int k = 0; k < subject_.robot.n() && subject_.has_friction; ++k) {
      const Joint& joint = subject_.robot.joints[k];
      load(6 + k) -= joint.viscous_friction * state.phidot(k) +
                     coulomb(k) * holds_[static_cast<std::size_t>(k)].slides;
    }
    if (subject_.contact) add_contact(out);
    return out;
  }

  void add_contact(Equations& at) const {
    const State& state = at.motion.state;
    const Eigen::Index n = state.phi.size();
    VectorXd velocity(6 + n);
    velocity << state.Omega, state.phidot;
    const Eigen::Quaterniond& R_NB = at.motion.base.orientation;
    const MatrixXd J = at.d.J.topRows(3);
    const SpringContact& contact = *subject_.contact;
    at.contact = contact_push(contact, *at.motion.target, at.motion.base * at.d.hand_position,
                              R_NB * Vector3d(J * velocity));
    if (is_pushed_) at.load += J.transpose() * (R_NB.conjugate() * at.contact.force);
    if (contact.servo_posture.size() == 0 || is_contact_over_) return;
    at.load.tail(n) -= contact.servo_stiffness.cwiseProduct(state.phi - contact.servo_posture) +
                       contact.servo_damping.cwiseProduct(state.phidot);
  }

  // Accelerations, those of joints at rest zero.
  VectorXd accelerations(const Equations& at) const {
    std::vector<bool> resting;
    for (const JointHold& hold : holds_) resting.push_back(hold.rests);
    return solve_but_for(resting, at.d.H, at.load);
  }

  VectorXd rate(const VectorXd& x, double time) {
    const Equations at = equations(x, time);
    const State& state = at.motion.state;
    const Eigen::Index own = 16 + 2 * state.phi.size();
    VectorXd out(x.size());
    out.head(own) << at.motion.base.orientation * Vector3d(state.Omega.head<3>()),
        quaternion_rate(x.segment<4>(3), state.Omega.tail<3>()), state.phidot, accelerations(at),
        -held_.wheels;
    if (!subject_.contact) return out;
    const BodyMotion& target = *at.motion.target;
    Vector3d acceleration = Vector3d::Zero(), spin_rate = at.contact.spin_rate;
    if (is_pushed_) {
      acceleration = -at.contact.force / subject_.contact->mass;
      spin_rate += at.contact.moment_rate;
    }
    out.tail<kBodySize>() << target.velocity,
        quaternion_rate(x.tail<kBodySize>().segment<4>(3), target.rate), acceleration, spin_rate;
    return out;
  }

  // Whether the hand is pushed at a state.
  static bool is_pushing(const ContactPush& contact) { return contact.gap < 0 && contact.push > 0; }

  // -1 or 1: joint k is beyond its lower or upper stop and goes on; 0: neither.
  int stop_reached(int k, const State& state) const {
    constexpr double kNoRate = 1e-12;
    const Joint& joint = subject_.robot.joints[k];
    if (holds_[static_cast<std::size_t>(k)].rests) return 0;
    if (state.phi(k) < joint.lower && state.phidot(k) < -kNoRate) return -1;
    return state.phi(k) > joint.upper && state.phidot(k) > kNoRate ? 1 : 0;
  }

  // Whether a joint at rest is pushed by more than friction and stop bear.
  bool is_pushed_off(int k, double push) const {
    constexpr double kRounding = 1e-9;
    const JointHold& hold = holds_[static_cast<std::size_t>(k)];
    const double free = hold.stop == 0 ? std::abs(push) : -hold.stop * push;
    return hold.rests && free > coulomb(k) * (1 + kRounding);
  }

  // Whether the equations of motion change at x.
  bool switches(const VectorXd& x, double time) {
    const Motion motion = motion_of(x);
    bool has_rest = false;
    for (int k = 0; k < subject_.robot.n(); ++k) {
      const JointHold& hold = holds_[static_cast<std::size_t>(k)];
      has_rest = has_rest || hold.rests;
      if (hold.slides * motion.state.phidot(k) < 0 || stop_reached(k, motion.state) != 0)
        return true;
    }
    if (!has_rest && !subject_.contact) return false;
    const Equations at = equations(x, time);
    if (subject_.contact && is_pushing(at.contact) != is_pushed_) return true;
    if (!has_rest) return false;
    const VectorXd missing = at.load - at.d.H * accelerations(at);
    for (int k = 0; k < subject_.robot.n(); ++k) {
      if (is_pushed_off(k, missing(6 + k))) return true;
    }
    return false;
  }

  // Shortens a step h with a switch to the first instant after it. @return the step
  double cut_at_switch(const VectorXd& from, double t, double h, VectorXd& next) {
    const double resolution = 1e-15 * std::max(1.0, std::abs(t));
    double low = 0, high = h;
    while (high - low > resolution) {
      const double middle = (low + high) / 2;
      VectorXd there;
      try_step(from, t, middle, there);
      normalise(there);
      if (switches(there, t + middle)) {
        high = middle;
        next = there;
      } else {
        low = middle;
      }
    }
    return high;
  }

  // The rate of joint k becomes `rate` by an impulse at that joint; joints of `fixed` keep theirs.
  void strike(VectorXd& x, int k, double rate, const std::vector<bool>& fixed) const {
    const Motion motion = motion_of(x);
    const Eigen::Index n = motion.state.phi.size();
    const Dynamics d = dynamics_of(subject_.robot, subject_.added_inertia, motion.state);
    const VectorXd jump = solve_but_for(fixed, d.H, VectorXd::Unit(6 + n, 6 + k));
    x.segment(7 + n, 6 + n) += (rate - motion.state.phidot(k)) / jump(6 + k) * jump;
    x(13 + n + k) = rate;
  }

  // Impulse of the stop that joint k has reached.
  void rebound(VectorXd& x, int k, int stop) {
    const double before = motion_of(x).state.phidot(k);
    const bool stays = subject_.stop_restitution * std::abs(before) < subject_.least_rebound;
    const bool is_slow = std::abs(before) < subject_.least_rebound;
    std::vector<bool> fixed(holds_.size(), false);
    for (std::size_t i = 0; i < holds_.size(); ++i) {
      has_two_at_stops_ = has_two_at_stops_ || (holds_[i].rests && holds_[i].stop != 0);
      fixed[i] = is_slow && holds_[i].rests;
    }
    strike(x, k, stays ? 0 : -subject_.stop_restitution * before, fixed);
    if (stays) holds_[static_cast<std::size_t>(k)] = {true, stop, 0};
  }

  // Makes the switches of a state. @return false when they do not end, or cannot be told
  bool make_switches(VectorXd& x, double time) {
    constexpr int kMost = 100;
    for (int round = 0; round < kMost && !has_two_at_stops_; ++round) {
      const State before = motion_of(x).state;
      const Eigen::Index n = before.phi.size();
      for (int k = 0; k < n; ++k) {
        const JointHold& hold = holds_[static_cast<std::size_t>(k)];
        if (hold.slides * before.phidot(k) < 0) x(13 + n + k) = 0;
        if (const int stop = stop_reached(k, motion_of(x).state); stop != 0) rebound(x, k, stop);
      }
      start_joints(x, time);
      if (!switches(x, time)) return true;
    }
    return false;
  }

  // Decides which joints without a rate move, and takes the contact as it is.
  void start_joints(const VectorXd& x, double time) {
    const State state = motion_of(x).state;
    std::vector<RestingJoint> resting;
    for (int k = 0; k < subject_.robot.n(); ++k) {
      JointHold& hold = holds_[static_cast<std::size_t>(k)];
      const double rate = state.phidot(k);
      const int sign = (rate > 0) - (rate < 0);
      if (rate != 0) hold = {false, 0, coulomb(k) > 0 ? sign : 0};
      if (rate != 0 || (coulomb(k) <= 0 && hold.stop == 0)) continue;
      hold.slides = 0;
      RestingJoint joint{k, coulomb(k)};
      if (hold.stop < 0) joint.least = 0;
      if (hold.stop > 0) joint.most = 0;
      resting.push_back(joint);
    }
    if (subject_.contact) {
      const bool pushes = is_pushing(equations(x, time).contact);
      is_contact_over_ = is_contact_over_ || (is_pushed_ && !pushes);
      is_pushed_ = pushes;
    }
    if (resting.empty()) return;
    const Equations at = equations(x, time);
    const std::vector<int> directions = starting_directions(at.d.H, at.load, resting);
    for (std::size_t i = 0; i < resting.size(); ++i) {
      JointHold& hold = holds_[static_cast<std::size_t>(resting[i].joint)];
      hold.rests = directions[i] == 0;
      if (hold.rests) continue;
      hold = {false, 0, resting[i].friction > 0 ? directions[i] : 0};
    }
  }

  // One step by Dormand and Prince; the error of the fourth-order solution over 1 + |x|.
  double try_step(const VectorXd& x, double t, double h, VectorXd& next) {
    const VectorXd k1 = rate(x, t);
    const VectorXd k2 = rate(x + h * (1. / 5 * k1), t + h / 5);
    const VectorXd k3 = rate(x + h * (3. / 40 * k1 + 9. / 40 * k2), t + 3 * h / 10);
    const VectorXd k4 = rate(x + h * (44. / 45 * k1 - 56. / 15 * k2 + 32. / 9 * k3), t + 4 * h / 5);
    const VectorXd k5 = rate(
        x + h * (19372. / 6561 * k1 - 25360. / 2187 * k2 + 64448. / 6561 * k3 - 212. / 729 * k4),
        t + 8 * h / 9);
    const VectorXd k6 = rate(x + h * (9017. / 3168 * k1 - 355. / 33 * k2 + 46732. / 5247 * k3 +
                                      49. / 176 * k4 - 5103. / 18656 * k5),
                             t + h);
    next = x + h * (35. / 384 * k1 + 500. / 1113 * k3 + 125. / 192 * k4 - 2187. / 6784 * k5 +
                    11. / 84 * k6);
    const VectorXd k7 = rate(next, t + h);
    const VectorXd error = h * (71. / 57600 * k1 - 71. / 16695 * k3 + 71. / 1920 * k4 -
                                17253. / 339200 * k5 + 22. / 525 * k6 - 1. / 40 * k7);
    return (error.array() / (1 + x.array().abs())).abs().maxCoeff();
  }

  const ControlledRobot& subject_;
  const ControlLaw& law_;
  double tolerance_;
  double step_ = 0.01;
  Command held_;
  std::vector<JointHold> holds_;  // n
  bool is_pushed_ = false;        // the hand, by the contact
  bool is_contact_over_ = false;  // the first one
  bool has_two_at_stops_ = false;
  VectorXd peaks_;
  Vector3d wheel_peaks_ = Vector3d::Zero();
  std::optional<Random> random_;  // of the sensors
  std::vector<Motion> told_;      // by them
};

}  // namespace

ControlledMotion controlled_motion(const ControlledRobot& subject, const ControlLaw& law,
                                   const Motion& start, const std::vector<double>& times,
                                   double tolerance, const StopCondition& stop) {
  ControlledMotion out;
  Run run(subject, law, tolerance);
  VectorXd x = packed(start);
  double t = 0;
  long commands = 0;
  if (law.period <= 0) run.command(start, 0);
  for (const double time : times) {
    while (true) {
      const double next = static_cast<double>(commands) * law.period;
      const bool commands_first = law.period > 0 && next < time * (1 - 1e-12);
      const double end = commands_first ? next : time;
      if (!run.advance(x, t, end, stop)) {
        out.has_two_at_stops = run.has_two_at_stops();
        return out;
      }
      t = end;
      if (!commands_first) break;
      run.command(run.motion_of(x), next);
      ++commands;
    }
    out.samples.push_back(run.motion_of(x));
  }
  out.peak_demanded_torques = run.peaks();
  out.peak_wheel_torques = run.wheel_peaks();
  out.complete = true;
  return out;
}

}  // namespace stillbase::reference
