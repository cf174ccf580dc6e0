#include <stillbase/simulation/controllers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <stillbase/core/linear_algebra.hpp>

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

/// (22) and (23) as a joint acceleration, with the moment t_b on the base.
JointVectord wanted_joint_acceleration(const Controller& controller, const PlantTerms& terms,
                                       const PlantState& state, const Vector3d& t_b) {
  const Matrix3Xd& A = terms.tilde.Htilde_omegaphi;
  const Vector3d omega = state.Omega.tail<3>();
  const Vector3d coupling = A * state.phidot;
  const Vector3d L_g = terms.tilde.Htilde_omega * omega + coupling;
  const MomentumTransfer transfer = compute_momentum_transfer(controller, A, L_g);
  const TildeBias<double> bias = compute_tilde_bias(terms.inertia, terms.bias);
  const Vector3d dot_omega = -controller.K_omega * omega;
  const Vector3d wanted = terms.tilde.Htilde_omega * dot_omega + bias.ctilde_omega - t_b;
  JointVectord phiddot = -transfer.joint_rates(A, wanted);
  if (controller.kind != ControllerKind::Rns) {
    const JointVectord rns = state.phidot - transfer.joint_rates(A, coupling);
    phiddot -= controller.K_phi * rns;
  }
  return phiddot;
}

/// Joint torques (18) for a moment t_b on the base.
JointVectord joint_torque(const Controller& controller, const RobotModel& robot,
                          const PlantTerms& terms, const PlantState& state, const Vector3d& t_b) {
  if (controller.kind == ControllerKind::None) return JointVectord::Zero(robot.n());
  const JointVectord chat = compute_hat_bias(terms.inertia, terms.bias);
  if (controller.kind == ControllerKind::JointDampingLiteral) {
    return chat - controller.K_phi * state.phidot;
  }
  const JointVectord phiddot = is_reaction_null_space_control(controller.kind)
                                   ? wanted_joint_acceleration(controller, terms, state, t_b)
                                   : JointVectord(-controller.K_phi * state.phidot);
  const HandJacobian<double> jacobian = compute_hand_jacobian(robot, terms.kinematics);
  const HatInertia<double> hat = compute_hat_inertia(terms.inertia, jacobian);
  JointVectord tau = chat + hat.Hhat_phi * phiddot;  // (18)
  if (!t_b.isZero(0)) {
    // With F_b, (18) reads Hhat_phi phi'' + chat = tau - H_bphi' H_b^-1 F_b.
    Vector6d F_b;
    F_b << Vector3d::Zero(), t_b;
    const Vector6d Omega_per_wrench = terms.inertia.H_b.ldlt().solve(F_b);
    tau.noalias() += terms.inertia.H_bphi.transpose() * Omega_per_wrench;
  }
  return tau;
}

JointVectord compensated_friction(const Controller& controller, const RobotModel& robot,
                                  const JointVectord& phidot) {
  JointVectord torque(phidot.size());
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[k];
    torque[k] = joint.viscous_friction * phidot[k] +
                joint.coulomb_friction * std::tanh(phidot[k] / controller.friction_transition_rate);
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

JointVectord MomentumTransfer::joint_rates(const Matrix3Xd& A, const Vector3d& b) const {
  const Vector3d along = inverse.cwiseProduct(U.transpose() * b);
  const Vector3d scaled = U * along;
  return A.transpose() * scaled;
}

Vector3d MomentumTransfer::unreachable(const Vector3d& momentum) const {
  const Vector3d along = (Vector3d::Ones() - share).cwiseProduct(U.transpose() * momentum);
  return U * along;
}

double momentum_edge(const Controller& controller, double sigma_max, double L_g) {
  return std::max(controller.rank_edge * sigma_max, L_g / controller.joint_rate_edge);
}

MomentumTransfer compute_momentum_transfer(const Controller& controller,
                                           const Matrix3Xd& Htilde_omegaphi, const Vector3d& L_g) {
  // The 3x3 eigenproblem of A A' instead of a singular value decomposition of A: it squares the
  // condition, which is harmless as everything below rank_edge (>> 1e-8) is given up anyway.
  const SymmetricEigen3 eigen = symmetric_eigen3(Htilde_omegaphi * Htilde_omegaphi.transpose());
  MomentumTransfer transfer;
  transfer.U = eigen.vectors.rowwise().reverse();
  transfer.sigma = eigen.values.reverse().cwiseMax(0.0).cwiseSqrt();
  transfer.share.setZero();
  transfer.inverse.setZero();
  if (transfer.sigma[0] <= 0) return transfer;
  const double edge = momentum_edge(controller, transfer.sigma[0], L_g.norm());
  for (int i = 0; i < 3; ++i) {
    const double ratio = transfer.sigma[i] / edge;
    const double larger = std::max(transfer.sigma[i], edge);
    transfer.share[i] = std::min(1.0, ratio * ratio);
    transfer.inverse[i] = 1 / (larger * larger);
    if (ratio >= 1) ++transfer.rank;
  }
  return transfer;
}

JointVectord control_torque(const Controller& controller, const RobotModel& robot,
                            const PlantTerms& terms, const PlantState& state) {
  return joint_torque(controller, robot, terms, state, Vector3d::Zero());
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
      command.tau += compensated_friction(controller, robot, state.phidot);
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
  command.tau = joint_torque(controller, robot, terms, state, t_b);
  if (controller.friction_compensation && controller.kind != ControllerKind::None) {
    command.tau += compensated_friction(controller, robot, state.phidot);
  }
  return command;
}

}  // namespace stillbase
