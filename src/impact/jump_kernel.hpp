// The lines of <stillbase/impact/jump.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/articulated_body.hpp>
#include <stillbase/impact/jump.hpp>

#include "dynamics/inertia_factor_kernel.hpp"
#include "dynamics/jacobian_kernel.hpp"

namespace stillbase {

template <class S>
ImpactJump<S> compute_jump(const InertiaFactor<S>& factor, const HandJacobian<S>& jacobian,
                           const Vector6<S>& Fbar) {
  const Eigen::Index n = jacobian.J_phi.cols();
  JointVector<S> tau(n);
  for (Eigen::Index k = 0; k < n; ++k) tau[k] = jacobian.J_phi.col(k).dot(Fbar);
  const Vector6<S> F_b = jacobian.R_bh.transpose() * Fbar;
  const GeneralizedMotion<S> d = solve_inertia(factor, F_b, tau);
  return {d.Omega, d.phidot};
}

namespace kernel {

template <class S>
ImpactJump<S> jump(const RobotModel& robot, const JointVector<S>& phi,
                   const JointVectord& added_inertia, const std::vector<bool>& locked,
                   const Vector6<S>& Fbar) {
  const Kinematics<S> kin = compute_kinematics(robot, phi);
  const HandJacobian<S> jacobian = compute_hand_jacobian(robot, kin);
  if (robot.n() < kArticulatedBodyJoints || robot.is_coupled()) {
    const InertiaMatrices<S> inertia = compute_inertia(robot, kin);
    return compute_jump(factorize_inertia(inertia, added_inertia, locked), jacobian, Fbar);
  }
  const ArticulatedBodies<S> bodies =
      factorize_articulated_bodies(robot, kin, added_inertia, locked);
  const Vector6<S> F_b = jacobian.R_bh.transpose() * Fbar;
  JointVector<S> tau(kin.n);
  for (int k = 0; k < kin.n; ++k) tau[k] = jacobian.J_phi.col(k).dot(Fbar);
  const GeneralizedMotion<S> d = solve_articulated_bodies(robot, bodies, F_b, tau);
  return {d.Omega, d.phidot};
}

}  // namespace kernel

template <class S>
ImpactJump<S> compute_jump(const RobotModel& robot, const JointVector<S>& phi,
                           const JointVectord& added_inertia, const std::vector<bool>& locked,
                           const Vector6<S>& Fbar) {
  return kernel::jump<S>(robot, phi, added_inertia, locked, Fbar);
}

template <class S>
Vector3<S> momentum_change(const InertiaMatrices<S>& inertia, const HandJacobian<S>& jacobian,
                           const Vector6<S>& Fbar) {
  const Vector3<S> f = Fbar.template head<3>();
  return (jacobian.r_bh() - inertia.r_bg).cross(f) + Fbar.template tail<3>();
}

}  // namespace stillbase
