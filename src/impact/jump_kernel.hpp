// The lines of <stillbase/impact/jump.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/articulated_body.hpp>
#include <stillbase/impact/jump.hpp>

#include "dynamics/cholesky.hpp"
#include "dynamics/inertia_kernel.hpp"

namespace stillbase {

template <class S>
ImpactFactor<S> factorize_impact(const InertiaMatrices<S>& inertia,
                                 const JointVectord& added_inertia,
                                 const std::vector<bool>& locked) {
  const Eigen::Index n = inertia.H_phi.rows();
  ImpactFactor<S> out;
  out.mass = inertia.mass;
  out.r_bg = inertia.r_bg;
  out.H_vphi = inertia.H_bphi.template topRows<3>();
  out.L.resize(3 + n, 3 + n);
  out.L.template topLeftCorner<3, 3>() = inertia_about_system_centroid(inertia);
  eliminate_base_translation(
      inertia,
      [&out](Eigen::Index k, const Vector3<S>& column) {
        for (Eigen::Index i = 0; i < 3; ++i) out.L(3 + k, i) = column[i];
      },
      [&out](Eigen::Index j, Eigen::Index k, const S& value) { out.L(3 + j, 3 + k) = value; });
  for (Eigen::Index k = 0; k < n; ++k) out.L(3 + k, 3 + k) += S(added_inertia[k]);
  for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(locked.size()); ++k) {
    if (!locked[static_cast<std::size_t>(k)]) continue;
    out.locked.set(static_cast<std::size_t>(k));
    for (Eigen::Index i = 0; i < 3 + k; ++i) out.L(3 + k, i) = S(0);
    for (Eigen::Index j = k + 1; j < n; ++j) out.L(3 + j, 3 + k) = S(0);
    out.L(3 + k, 3 + k) = S(1);
  }
  factorize_cholesky(out.L);
  return out;
}

template <class S>
ImpactJump<S> solve_impact(const ImpactFactor<S>& factor, const Vector6<S>& F_b,
                           const JointVector<S>& tau) {
  const Eigen::Index n = factor.H_vphi.cols();
  const Vector3<S> f = F_b.template head<3>();
  const S inverse_mass = S(1) / factor.mass;
  const Vector3<S> v_g = f * inverse_mass;  // of the system centroid
  Eigen::Matrix<S, Eigen::Dynamic, 1, Eigen::ColMajor, ImpactFactor<S>::kMax, 1> x(3 + n);
  x.template head<3>() = F_b.template tail<3>() - factor.r_bg.cross(f);
  for (Eigen::Index k = 0; k < n; ++k) {
    x[3 + k] = factor.locked[static_cast<std::size_t>(k)]
                   ? S(0)
                   : S(tau[k] - factor.H_vphi.col(k).dot(v_g));
  }
  solve_cholesky(factor.L, x);
  ImpactJump<S> out;
  const Vector3<S> omega = x.template head<3>();
  out.Delta_phidot = x.tail(n);
  Vector3<S> p = Vector3<S>::Zero();
  for (Eigen::Index k = 0; k < n; ++k) p += factor.H_vphi.col(k) * x[3 + k];
  out.Delta_Omega.template head<3>() = v_g - omega.cross(factor.r_bg) - p * inverse_mass;
  out.Delta_Omega.template tail<3>() = omega;
  return out;
}

template <class S>
ImpactJump<S> compute_jump(const ImpactFactor<S>& factor, const HandJacobian<S>& jacobian,
                           const Vector6<S>& Fbar) {
  const Eigen::Index n = jacobian.J_phi.cols();
  JointVector<S> tau(n);
  for (Eigen::Index k = 0; k < n; ++k) tau[k] = jacobian.J_phi.col(k).dot(Fbar);
  const Vector6<S> F_b = jacobian.R_bh.transpose() * Fbar;
  return solve_impact(factor, F_b, tau);
}

template <class S>
ImpactJump<S> compute_jump(const RobotModel& robot, const JointVector<S>& phi,
                           const JointVectord& added_inertia, const std::vector<bool>& locked,
                           const Vector6<S>& Fbar) {
  const Kinematics<S> kin = compute_kinematics(robot, phi);
  const HandJacobian<S> jacobian = compute_hand_jacobian(robot, kin);
  if (robot.n() < kArticulatedBodyJoints) {
    const InertiaMatrices<S> inertia = compute_inertia(robot, kin);
    return compute_jump(factorize_impact(inertia, added_inertia, locked), jacobian, Fbar);
  }
  const ArticulatedBodies<S> bodies =
      factorize_articulated_bodies(robot, kin, added_inertia, locked);
  const Vector6<S> F_b = jacobian.R_bh.transpose() * Fbar;
  JointVector<S> tau(kin.n);
  for (int k = 0; k < kin.n; ++k) tau[k] = jacobian.J_phi.col(k).dot(Fbar);
  const GeneralizedMotion<S> d = solve_articulated_bodies(robot, bodies, F_b, tau);
  return {d.Omega, d.phidot};
}

template <class S>
Vector3<S> momentum_change(const InertiaMatrices<S>& inertia, const HandJacobian<S>& jacobian,
                           const Vector6<S>& Fbar) {
  const Vector3<S> r_bh(jacobian.R_bh(1, 5), jacobian.R_bh(2, 3), jacobian.R_bh(0, 4));
  const Vector3<S> f = Fbar.template head<3>();
  return (r_bh - inertia.r_bg).cross(f) + Fbar.template tail<3>();
}

}  // namespace stillbase
