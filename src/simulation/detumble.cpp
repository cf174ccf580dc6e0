// The controller `detumble`: joints and base to rest in least time within the loads that joints,
// grip and wheels bear.
#include <algorithm>
#include <cmath>

#include <stillbase/simulation/controllers.hpp>

#include "simulation/wheels.hpp"

namespace stillbase {
namespace {

/// What an acceleration takes: joint torques (18) and the wrench through the grip.
struct Loads {
  JointVectord tau;                    ///< n
  Vector3d force = Vector3d::Zero();   ///< of the grip; zero without limits
  Vector3d moment = Vector3d::Zero();  ///< the same
};

/// Coasting, u = 0 and phi'' = 0, and what unit steps of both commands add.
class LoadModel {
 public:
  LoadModel(const RobotModel& robot, const PlantTerms& terms, const PlantState& state,
            const HeldTarget* held)
      : robot_(robot), terms_(terms), state_(state), held_(held), H_b_(terms.inertia.H_b.ldlt()) {}

  /// @param t_b moment on the base, in B, N m
  Loads at(const Vector3d& t_b, const JointVectord& phiddot) const {
    Vector6d F_b;
    F_b << Vector3d::Zero(), t_b;
    const InertiaMatrices<double>& inertia = terms_.inertia;
    PlantAcceleration acceleration;
    const Vector6d load = F_b - terms_.bias.c_b - inertia.H_bphi * phiddot;
    acceleration.dot_Omega = H_b_.solve(load);
    acceleration.phiddot = phiddot;
    // On its own: within a sum the product would be a vector on the heap.
    const JointVectord of_joints = inertia.H_phi * phiddot;
    Loads loads;
    loads.tau = inertia.H_bphi.transpose() * acceleration.dot_Omega + of_joints + terms_.bias.c_phi;
    if (held_ == nullptr) return loads;
    const Vector6d wrench = grip_wrench(*held_, robot_, terms_.kinematics, state_, acceleration);
    loads.force = wrench.head<3>();
    loads.moment = wrench.tail<3>();
    return loads;
  }

 private:
  const RobotModel& robot_;
  const PlantTerms& terms_;
  const PlantState& state_;
  const HeldTarget* held_;
  Eigen::LDLT<Matrix6d> H_b_;
};

/// Largest s in [0, 1] with |from + s (to - from)| <= max(limit, |from|).
template <class V>
double share_within(const V& from, const V& to, double limit) {
  const V step = to - from;
  const double most = std::max(limit * limit, from.squaredNorm());
  if (to.squaredNorm() <= most) return 1;
  // a s^2 + 2 b s - c = 0, a > 0, c >= 0: one root is not negative.
  const double a = step.squaredNorm(), b = from.dot(step), c = most - from.squaredNorm();
  const double root = std::sqrt(b * b + a * c);
  const double s = b > 0 ? c / (b + root) : (root - b) / a;
  return std::clamp(s, 0.0, 1.0);
}

/// The same over all loads.
double share_within(const Controller& controller, const GripSpec& grip, const RobotModel& robot,
                    const Loads& from, const Loads& to) {
  const double kept = 1 - controller.reserve;
  double share = 1;
  for (int k = 0; k < robot.n(); ++k) {
    using Scalar = Eigen::Matrix<double, 1, 1>;
    const double limit = robot.joints[static_cast<std::size_t>(k)].max_effort;
    if (!std::isfinite(limit)) continue;
    share = std::min(share, share_within(Scalar(from.tau[k]), Scalar(to.tau[k]), kept * limit));
  }
  if (grip.force) share = std::min(share, share_within(from.force, to.force, kept * *grip.force));
  if (grip.moment) {
    share = std::min(share, share_within(from.moment, to.moment, kept * *grip.moment));
  }
  return share;
}

/// u for b = 1.
Vector3d full_wheel_torque(const Controller& controller, const WheelSpec& wheels, Vector3d L_g,
                           const Vector3d& wheel_momentum, double period) {
  for (int i = 0; i < 3; ++i) {
    if (!(wheels.torque[i] > 0) || wheel_room(wheels, wheel_momentum, i, L_g[i]) <= 0) L_g[i] = 0;
  }
  double k = controller.K_detumble;
  if (period > 0) k = std::min(k, 0.5 / period);  // a held command must not overshoot
  for (int i = 0; i < 3; ++i) {
    if (L_g[i] != 0) k = std::min(k, wheels.torque[i] / std::abs(L_g[i]));
  }
  const Vector3d u = -k * L_g;
  return period > 0 ? within_wheel_room(wheels, wheel_momentum, u, period) : u;
}

}  // namespace

ControlCommand detumble_command(const Controller& controller, const WheelSpec& wheels,
                                const Grasp& grasp, const RobotModel& robot,
                                const PlantTerms& terms, const PlantState& state, double period) {
  const HeldTarget* const held = grasp.limits.is_limited() ? grasp.known_target() : nullptr;
  const LoadModel model(robot, terms, state, held);
  const auto share = [&](const Loads& from, const Loads& to) {
    return share_within(controller, grasp.limits, robot, from, to);
  };
  const Vector3d gyroscopic = -state.Omega.tail<3>().cross(state.wheel_momentum);
  const JointVectord still = JointVectord::Zero(robot.n());
  const JointVectord braking = -controller.K_phi * state.phidot;
  const Loads coasting = model.at(gyroscopic, still);
  const JointVectord phiddot = share(coasting, model.at(gyroscopic, braking)) * braking;
  ControlCommand command;
  if (wheels.exist()) {
    const Momentum<double> momentum =
        compute_momentum(terms.inertia, terms.tilde, state.Omega, state.phidot);
    const Vector3d u =
        full_wheel_torque(controller, wheels, momentum.L_g, state.wheel_momentum, period);
    const Loads with_joints = model.at(gyroscopic, phiddot);
    command.wheel_torque = share(with_joints, model.at(gyroscopic + u, phiddot)) * u;
  }
  command.tau = model.at(gyroscopic + command.wheel_torque, phiddot).tau;
  return command;
}

}  // namespace stillbase
