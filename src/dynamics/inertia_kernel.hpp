// The lines of <stillbase/dynamics/inertia.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/inertia.hpp>

#include <algorithm>

#include "dynamics/cholesky.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "dynamics/rigid_inertia.hpp"

namespace stillbase {

/// The twist of body k's joint under unit rate of its coordinate, about the base centroid: linear
/// and angular part.
template <class S, class Robot>
[[gnu::always_inline]] inline void put_axis(const Robot& robot, const Joint& joint,
                                            const Kinematics<S>& kin, int k, Vector3<S>& v,
                                            Vector3<S>& w) {
  const Vector3<S> z = kin.z(k);
  if (joint.is_prismatic()) {
    v = z;
    w.setZero();
  } else {
    v = kin.o[k].cross(z);
    w = z;
  }
  if (!robot.is_coupled()) return;
  const S ratio(robot.couplings[k].ratio);
  v *= ratio;
  w *= ratio;
}

namespace kernel {

enum class InertiaParts {
  All,
  Coupling  ///< H_phi is left empty
};

/// What the whole robot as one body says.
template <class S>
void describe_whole(const RigidInertia<S>& total, InertiaMatrices<S>& out) {
  out.mass = total.m;
  out.r_bg = total.h / total.m;
  put_spatial_inertia(total, out.H_b);
}

template <class S, InertiaParts parts = InertiaParts::All, class Robot>
InertiaMatrices<S> inertia(const Robot& robot, const Kinematics<S>& kin) {
  constexpr bool has_arm = parts == InertiaParts::All;
  const int bodies = kin.n, n = robot.n();
  const std::vector<Joint>& tree = robot.tree();
  const bool is_coupled = robot.is_coupled();
  InertiaMatrices<S> out;
  // Twist of unit rate of joint k about the base centroid: linear and angular part.
  BodyWorkspace<Vector3<S>, S> axis_v, axis_w;
  out.I.resize(bodies);
  out.subtree.resize(bodies);
  RigidInertia<S>* const subtrees = out.subtree.data();
  RigidInertia<S> total{S(robot.base.mass), Vector3<S>::Zero(),
                        robot.base.inertia.template cast<S>()};
  for (int k = 0; k < bodies; ++k) {
    out.I[k] = inertia_in_base_axes(robot, kin, k);
    subtrees[k] = inertia_about_base(robot, kin, k, out.I[k]);
    put_axis(robot, tree[k], kin, k, axis_v[k], axis_w[k]);
  }

  out.H_bphi.resize(6, n);
  if (is_coupled) out.H_bphi.setZero();
  if (has_arm) {
    out.H_phi.resize(n, n);
    out.H_phi.setZero();
  }
  for (int k = bodies - 1; k >= 0; --k) {
    const RigidInertia<S>& subtree = subtrees[k];
    const Joint& joint = tree[k];
    // Momentum of the subtree under unit rate of joint k: Ic_k S_k.
    const Vector3<S> p = axis_v[k] * subtree.m + axis_w[k].cross(subtree.h);
    Vector3<S> L = subtree.h.cross(axis_v[k]);
    L.noalias() += subtree.I * axis_w[k];
    if (is_coupled) {
      // Several bodies share a coordinate: the congruence adds up.
      const int row = robot.coordinate(k);
      out.H_bphi.template block<3, 1>(0, row) += p;
      out.H_bphi.template block<3, 1>(3, row) += L;
      const double ratio = robot.couplings[k].ratio;
      if (has_arm) {
        out.H_phi(row, row) += axis_v[k].dot(p) + axis_w[k].dot(L);
        if (joint.rotor_inertia != 0) {
          out.H_phi(row, row) += S(ratio * ratio * joint.reflected_inertia());
        }
      }
      for (int j = joint.parent; has_arm && j != kBase; j = tree[j].parent) {
        const int column = robot.coordinate(j);
        const S value = axis_v[j].dot(p) + axis_w[j].dot(L);
        out.H_phi(row, column) += value;
        out.H_phi(column, row) += value;
      }
    } else {
      out.H_bphi.template block<3, 1>(0, k) = p;
      out.H_bphi.template block<3, 1>(3, k) = L;
      for (int j = k; has_arm && j != kBase; j = tree[j].parent) {
        const S value = axis_v[j].dot(p) + axis_w[j].dot(L);
        out.H_phi(j, k) = value;
        out.H_phi(k, j) = value;
      }
      if (has_arm && joint.rotor_inertia != 0) out.H_phi(k, k) += S(joint.reflected_inertia());
    }
    (joint.parent == kBase ? total : subtrees[joint.parent]).add(subtree);
  }

  describe_whole(total, out);
  return out;
}

}  // namespace kernel

template <class S>
InertiaMatrices<S> compute_inertia(const RobotModel& robot, const Kinematics<S>& kin) {
  return kernel::inertia<S>(robot, kin);
}

/// Column k of Htilde_omegaphi, see TildeInertia.
template <class S>
[[gnu::always_inline]] inline Vector3<S> angular_coupling(const InertiaMatrices<S>& inertia,
                                                          Eigen::Index k) {
  const Vector3<S> p = inertia.H_bphi.template block<3, 1>(0, k);
  return inertia.H_bphi.template block<3, 1>(3, k) - inertia.r_bg.cross(p);
}

template <class S>
TildeInertia<S> compute_tilde_inertia(const InertiaMatrices<S>& inertia) {
  const Eigen::Index n = inertia.H_phi.rows();
  TildeInertia<S> out;
  out.Htilde_omega =
      inertia.H_b.template bottomRightCorner<3, 3>() - parallel_axis(inertia.mass, inertia.r_bg);
  out.Htilde_omegaphi.resize(3, n);
  out.Htilde_phi.resize(n, n);
  const S inverse_mass = S(1) / inertia.mass;
  for (Eigen::Index k = 0; k < n; ++k) {
    out.Htilde_omegaphi.col(k) = angular_coupling(inertia, k);
    const Vector3<S> v = inertia.H_bphi.template block<3, 1>(0, k) * inverse_mass;
    for (Eigen::Index j = k; j < n; ++j) {
      const S value = inertia.H_phi(j, k) - inertia.H_bphi.template block<3, 1>(0, j).dot(v);
      out.Htilde_phi(j, k) = value;
      out.Htilde_phi(k, j) = value;
    }
  }
  return out;
}

template <class S>
HatInertia<S> compute_hat_inertia(const InertiaMatrices<S>& inertia,
                                  const HandJacobian<S>& jacobian) {
  const TildeInertia<S> tilde = compute_tilde_inertia(inertia);
  const Eigen::Index n = inertia.H_phi.rows();
  Matrix3<S> L = tilde.Htilde_omega;
  factorize_cholesky(L);
  // H_b^-1 H_bphi: base motion per joint rate at zero momentum, with the sign turned.
  Matrix6X<S> X(6, n);
  HatInertia<S> out;
  for (Eigen::Index k = 0; k < n; ++k) {
    Vector3<S> omega = tilde.Htilde_omegaphi.col(k);
    solve_cholesky(L, omega);
    X.template block<3, 1>(3, k) = omega;
    X.template block<3, 1>(0, k) =
        inertia.H_bphi.template block<3, 1>(0, k) / inertia.mass - omega.cross(inertia.r_bg);
  }
  out.Hhat_phi = tilde.Htilde_phi;
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index j = k; j < n; ++j) {
      const S value =
          tilde.Htilde_phi(j, k) - tilde.Htilde_omegaphi.col(j).dot(X.template block<3, 1>(3, k));
      out.Hhat_phi(j, k) = value;
      out.Hhat_phi(k, j) = value;
    }
  }
  out.Jhat_phi = jacobian.J_phi;
  for (Eigen::Index k = 0; k < n; ++k) {
    const Vector3<S> omega = X.template block<3, 1>(3, k);
    out.Jhat_phi.template block<3, 1>(0, k) -=
        X.template block<3, 1>(0, k) + omega.cross(jacobian.r_bh());
    out.Jhat_phi.template block<3, 1>(3, k) -= omega;
  }
  return out;
}

}  // namespace stillbase
