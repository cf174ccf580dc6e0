#include <algorithm>
#include <cassert>

#include "dynamics/wide_joint_values.hpp"
#include "impact/jump_kernel.hpp"

namespace stillbase {

Matrix6d extended_inverse_inertia(const InertiaFactor<double>& factor,
                                  const HandJacobian<double>& jacobian) {
  Matrix6d W;
  for (int i = 0; i < 6; ++i) {
    const ImpactJump<double> d = compute_jump<double>(factor, jacobian, Vector6d::Unit(i));
    W.col(i) = jacobian.R_bh * d.Delta_Omega + jacobian.J_phi * d.Delta_phidot;
  }
  return (W + W.transpose()) / 2;
}

Eigen::Matrix<double, 3, 6> base_reaction_matrix(const InertiaFactor<double>& factor,
                                                 const HandJacobian<double>& jacobian) {
  // Row i of B is the hand velocity that a unit moment impulse i on the base would cause.
  Eigen::Matrix<double, 3, 6> B;
  const JointVectord no_torque = JointVectord::Zero(jacobian.J_phi.cols());
  for (int i = 0; i < 3; ++i) {
    const auto d = solve_inertia<double>(factor, Vector6d::Unit(3 + i), no_torque);
    B.row(i) = jacobian.R_bh * d.Omega + jacobian.J_phi * d.phidot;
  }
  return B;
}

template <>
ImpactJump<double> compute_jump(const RobotModel& robot, const JointVectord& phi,
                                const JointVectord& added_inertia, const std::vector<bool>& locked,
                                const Vector6d& Fbar) {
  assert(added_inertia.size() == robot.n());
  const WideKernel* const wide = wide_kernel(robot);
  if (wide == nullptr || std::find(locked.begin(), locked.end(), true) != locked.end()) {
    return kernel::jump<double>(robot, phi, added_inertia, locked, Fbar);
  }
  ImpactJump<double> out;
  out.Delta_phidot.resize(robot.n());
  wide->jump(robot, WideJointValues(robot, phi).plain(), added_inertia.data(), Fbar.data(),
             {out.Delta_Omega.data(), out.Delta_phidot.data()});
  return out;
}

template ImpactJump<double> compute_jump(const InertiaFactor<double>&, const HandJacobian<double>&,
                                         const Vector6<double>&);
template Vector3<double> momentum_change(const InertiaMatrices<double>&,
                                         const HandJacobian<double>&, const Vector6<double>&);

}  // namespace stillbase
