// The lines of <stillbase/dynamics/bias.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/bias.hpp>

#include "dynamics/cholesky.hpp"
#include "dynamics/kinematics_kernel.hpp"

namespace stillbase {

namespace kernel {

template <class S, class Robot>
BiasForces<S> bias(const Robot& robot, const Kinematics<S>& kin, const Matrix3<S>* I,
                   const Vector6<S>& Omega, const JointVector<S>& phidot) {
  const int n = kin.n;  // bodies
  const std::vector<Joint>& tree = robot.tree();
  const bool is_coupled = robot.is_coupled();
  const auto rate_of = [&](int k) -> S {
    return is_coupled ? phidot[robot.couplings[k].joint] * S(robot.couplings[k].ratio) : phidot[k];
  };
  const Vector3<S> v = Omega.template head<3>();
  const Vector3<S> omega_b = Omega.template tail<3>();

  // Angular rate, its inertial derivative, acceleration of o_k.
  BodyWorkspace<Vector3<S>, S> omega, alpha, a_o;
  BodyWorkspace<Vector3<S>, S> f, t;  // wrench on the subtree about the base centroid
  // With zero derivative of the B components the base still has the inertial acceleration omega x
  // v.
  const Vector3<S> a_b = omega_b.cross(v);
  for (int k = 0; k < n; ++k) {
    const Joint& joint = tree[k];
    const bool on_base = joint.parent == kBase;
    const Vector3<S> omega_p = on_base ? omega_b : omega[joint.parent];
    Vector3<S> d = kin.o[k];
    Vector3<S> a = a_b;
    Vector3<S> alpha_p = Vector3<S>::Zero();
    if (!on_base) {
      d -= kin.o[joint.parent];
      a = a_o[joint.parent];
      alpha_p = alpha[joint.parent];
    }
    const Vector3<S> rate = kin.z(k) * rate_of(k);
    a_o[k] = a + alpha_p.cross(d) + omega_p.cross(omega_p.cross(d));
    omega[k] = omega_p;
    alpha[k] = alpha_p;
    if (joint.is_prismatic()) {
      a_o[k] += S(2) * omega_p.cross(rate);
    } else {
      omega[k] += rate;
      alpha[k] += omega_p.cross(rate);
    }
    const Vector3<S> r = kin.c[k] - kin.o[k];
    const Vector3<S> a_c = a_o[k] + alpha[k].cross(r) + omega[k].cross(omega[k].cross(r));
    f[k] = a_c * S(robot.bodies[k].mass);
    const Vector3<S> I_omega = I[k] * omega[k];
    t[k] = I[k] * alpha[k] + omega[k].cross(I_omega) + kin.c[k].cross(f[k]);
  }

  BiasForces<S> out;
  out.c_phi.resize(robot.n());
  if (is_coupled) out.c_phi.setZero();
  const Vector3<S> I_omega_b = robot.base.inertia.template cast<S>() * omega_b;
  Vector3<S> f_b = a_b * S(robot.base.mass);
  Vector3<S> t_b = omega_b.cross(I_omega_b);
  for (int k = n - 1; k >= 0; --k) {
    const Joint& joint = tree[k];
    const Vector3<S> z = kin.z(k);
    S force;
    if (joint.is_prismatic()) {
      force = z.dot(f[k]);
    } else {
      force = z.dot(t[k] - kin.o[k].cross(f[k]));
    }
    if (is_coupled) {
      out.c_phi[robot.couplings[k].joint] += force * S(robot.couplings[k].ratio);
    } else {
      out.c_phi[k] = force;
    }
    if (joint.parent == kBase) {
      f_b += f[k];
      t_b += t[k];
    } else {
      f[joint.parent] += f[k];
      t[joint.parent] += t[k];
    }
  }
  out.c_b.template head<3>() = f_b;
  out.c_b.template tail<3>() = t_b;
  return out;
}

}  // namespace kernel

template <class S>
BiasForces<S> compute_bias(const RobotModel& robot, const Kinematics<S>& kin, const Matrix3<S>* I,
                           const Vector6<S>& Omega, const JointVector<S>& phidot) {
  return kernel::bias<S>(robot, kin, I, Omega, phidot);
}

template <class S>
BiasForces<S> compute_bias(const RobotModel& robot, const Kinematics<S>& kin,
                           const InertiaMatrices<S>& inertia, const Vector6<S>& Omega,
                           const JointVector<S>& phidot) {
  return compute_bias(robot, kin, inertia.I.data(), Omega, phidot);
}

template <class S>
TildeBias<S> compute_tilde_bias(const InertiaMatrices<S>& inertia, const BiasForces<S>& bias) {
  const Vector3<S> c_v = bias.c_b.template head<3>();
  TildeBias<S> out;
  out.ctilde_omega = bias.c_b.template tail<3>() - inertia.r_bg.cross(c_v);
  out.ctilde_phi = bias.c_phi;
  for (Eigen::Index k = 0; k < bias.c_phi.size(); ++k) {
    out.ctilde_phi[k] -= inertia.H_bphi.template block<3, 1>(0, k).dot(c_v) / inertia.mass;
  }
  return out;
}

template <class S>
JointVector<S> compute_hat_bias(const InertiaMatrices<S>& inertia, const BiasForces<S>& bias) {
  const TildeInertia<S> tilde = compute_tilde_inertia(inertia);
  TildeBias<S> reduced = compute_tilde_bias(inertia, bias);
  Matrix3<S> L = tilde.Htilde_omega;
  factorize_cholesky(L);
  solve_cholesky(L, reduced.ctilde_omega);
  JointVector<S> chat = reduced.ctilde_phi;
  for (Eigen::Index k = 0; k < chat.size(); ++k) {
    chat[k] -= tilde.Htilde_omegaphi.col(k).dot(reduced.ctilde_omega);
  }
  return chat;
}

}  // namespace stillbase
