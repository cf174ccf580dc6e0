#include <stillbase/simulation/controllers.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace stillbase {
namespace {

constexpr std::array<std::pair<ControllerKind, std::string_view>, 5> kNames{{
    {ControllerKind::None, "none"},
    {ControllerKind::JointDamping, "joint_damping"},
    {ControllerKind::JointDampingLiteral, "joint_damping_literal"},
    {ControllerKind::Rns, "rns"},
    {ControllerKind::RnsDamped, "rns_damped"},
}};

/// (22) and (23) as a joint acceleration.
JointVectord wanted_joint_acceleration(const Controller& controller, const PlantTerms& terms,
                                       const PlantState& state) {
  const Matrix3Xd& A = terms.tilde.Htilde_omegaphi;
  const Vector3d omega = state.Omega.tail<3>();
  const Vector3d coupling = A * state.phidot;
  const Vector3d L_g = terms.tilde.Htilde_omega * omega + coupling;
  const MomentumTransfer transfer = compute_momentum_transfer(controller, A, L_g);
  const TildeBias<double> bias = compute_tilde_bias(terms.inertia, terms.bias);
  const Vector3d dot_omega = -controller.K_omega * omega;
  const Vector3d wanted = terms.tilde.Htilde_omega * dot_omega + bias.ctilde_omega;
  JointVectord phiddot = -transfer.joint_rates(A, wanted);
  if (controller.kind == ControllerKind::RnsDamped) {
    const JointVectord rns = state.phidot - transfer.joint_rates(A, coupling);
    phiddot -= controller.K_phi * rns;
  }
  return phiddot;
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
  for (const auto& entry : kNames) names.emplace_back(entry.second);
  return names;
}

bool is_reaction_null_space_control(ControllerKind kind) {
  return kind == ControllerKind::Rns || kind == ControllerKind::RnsDamped;
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
  const Matrix3d AAt = Htilde_omegaphi * Htilde_omegaphi.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(AAt);
  MomentumTransfer transfer;
  transfer.U = eigen.eigenvectors().rowwise().reverse();
  transfer.sigma = eigen.eigenvalues().reverse().cwiseMax(0.0).cwiseSqrt();
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
  if (controller.kind == ControllerKind::None) return JointVectord::Zero(robot.n());
  const JointVectord chat = compute_hat_bias(terms.inertia, terms.bias);
  if (controller.kind == ControllerKind::JointDampingLiteral) {
    return chat - controller.K_phi * state.phidot;
  }
  const JointVectord phiddot = is_reaction_null_space_control(controller.kind)
                                   ? wanted_joint_acceleration(controller, terms, state)
                                   : JointVectord(-controller.K_phi * state.phidot);
  const HandJacobian<double> jacobian = compute_hand_jacobian(robot, terms.kinematics);
  const HatInertia<double> hat = compute_hat_inertia(terms.inertia, jacobian);
  return chat + hat.Hhat_phi * phiddot;  // (18)
}

}  // namespace stillbase
