#include <stillbase/simulation/controllers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "simulation/controller_kernel.hpp"
#include "simulation/wheels.hpp"

namespace stillbase {
namespace {

constexpr std::array<std::pair<ControllerKind, std::string_view>, 7> kNames{{
    {ControllerKind::None, "none"},
    {ControllerKind::JointDamping, "joint_damping"},
    {ControllerKind::JointDampingLiteral, "joint_damping_literal"},
    {ControllerKind::Rns, "rns"},
    {ControllerKind::RnsDamped, "rns_damped"},
    {ControllerKind::RnsHandback, "rns_handback"},
    {ControllerKind::Detumble, "detumble"},
}};

/// Joint torques (18) for a moment t_b on the base.
JointVectord torque_with(const Controller& controller, const PlantTerms& terms,
                         const PlantState& state, const Vector3d& t_b) {
  return joint_torque<double>(controller, terms, terms.tilde, state.Omega.tail<3>(), state.phidot,
                              t_b);
}

JointVectord friction_torques(const Controller& controller, const RobotModel& robot,
                              const JointVectord& phidot) {
  JointVectord torque(phidot.size());
  for (int k = 0; k < robot.n(); ++k) {
    torque[k] = compensated_friction<double>(controller, robot.joints[k], phidot[k]);
  }
  return torque;
}

/// u of rns_handback: against L_g, as hard as the gain says and the wheels can.
Vector3d handback_torque(const Controller& controller, const WheelSpec& wheels,
                         const PlantTerms& terms, const PlantState& state, double period) {
  const Momentum<double> momentum =
      compute_momentum(terms.inertia, terms.tilde, state.Omega, state.phidot);
  Vector3d u = -controller.K_handback * momentum.L_g;
  for (int i = 0; i < 3; ++i) {
    if (!(wheels.torque[i] > 0) || wheel_room(wheels, state.wheel_momentum, i, -u[i]) <= 0)
      u[i] = 0;
  }
  double share = 1;
  for (int i = 0; i < 3; ++i) {
    const double size = std::abs(u[i]);
    if (size > wheels.torque[i]) share = std::min(share, wheels.torque[i] / size);
  }
  if (share < 1) u *= share;
  return period > 0 ? within_wheel_room(wheels, state.wheel_momentum, u, period) : u;
}

}  // namespace

std::string to_string(ControllerKind kind) {
  for (const auto& [value, name] : kNames) {
    if (value == kind) return std::string(name);
  }
  return "unknown";
}

std::optional<ControllerKind> controller_from_name(std::string_view name) {
  for (const auto& [value, text] : kNames) {
    if (text == name) return value;
  }
  return std::nullopt;
}

std::vector<std::string> controller_names() {
  std::vector<std::string> names;
  names.reserve(kNames.size());
  for (const auto& entry : kNames) names.emplace_back(entry.second);
  return names;
}

bool is_reaction_null_space_control(ControllerKind kind) {
  return kind == ControllerKind::Rns || kind == ControllerKind::RnsDamped ||
         kind == ControllerKind::RnsHandback;
}

std::optional<Controller> controller_of(const PostImpactSpec& spec, std::string_view name) {
  const auto kind = controller_from_name(name);
  if (!kind) return std::nullopt;
  Controller controller;
  controller.kind = *kind;
  controller.K_omega = spec.K_omega;
  controller.K_phi = spec.K_phi;
  controller.handback_start = spec.handback_start;
  controller.K_handback = spec.handback_gain;
  controller.friction_compensation = spec.model.friction_scale > 0;
  return controller;
}

std::optional<Controller> chosen_controller(const PostImpactSpec& spec) {
  if (spec.controllers.empty()) return std::nullopt;
  return controller_of(spec, spec.controllers.front());
}

bool chooses(const PostImpactSpec& spec, ControllerKind kind) {
  const auto controller = chosen_controller(spec);
  return controller && controller->kind == kind;
}

template double momentum_edge(const Controller&, const double&, const double&);
template struct MomentumTransfer<double>;
template MomentumTransfer<double> compute_momentum_transfer(const Controller&, const Matrix3Xd&,
                                                            const Vector3d&);

JointVectord control_torque(const Controller& controller, const PlantTerms& terms,
                            const PlantState& state) {
  return torque_with(controller, terms, state, Vector3d::Zero());
}

Vector3d thruster_torque(const ThrusterSpec& thrusters, const PlantTerms& terms,
                         const PlantState& state) {
  const Vector3d omega = state.Omega.tail<3>();
  if (!thrusters.exist() || omega.norm() < thrusters.dead_band) return Vector3d::Zero();
  const Vector3d wanted = -thrusters.gain * (terms.tilde.Htilde_omega * omega);
  return wanted.cwiseMax(-thrusters.torque).cwiseMin(thrusters.torque);
}

ControlCommand control_command(const Controller& controller, const WheelSpec& wheels,
                               const RobotModel& robot, const PlantTerms& terms,
                               const PlantState& state, double elapsed, const Grasp& grasp,
                               double period) {
  ControlCommand command;
  if (controller.kind == ControllerKind::Detumble) {
    command = detumble_command(controller, wheels, grasp, robot, terms, state, period);
    if (controller.friction_compensation) {
      command.tau += friction_torques(controller, robot, state.phidot);
    }
    return command;
  }
  Vector3d t_b = Vector3d::Zero();
  if (wheels.exist()) {
    const bool hands_back =
        controller.kind == ControllerKind::RnsHandback && elapsed >= controller.handback_start;
    if (hands_back) {
      command.wheel_torque = handback_torque(controller, wheels, terms, state, period);
    }
    t_b = command.wheel_torque - state.Omega.tail<3>().cross(state.wheel_momentum);
  }
  command.tau = torque_with(controller, terms, state, t_b);
  if (controller.friction_compensation && controller.kind != ControllerKind::None) {
    command.tau += friction_torques(controller, robot, state.phidot);
  }
  return command;
}

}  // namespace stillbase
