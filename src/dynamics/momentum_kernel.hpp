// The lines of <stillbase/dynamics/momentum.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/momentum.hpp>

#include "dynamics/cholesky.hpp"

namespace stillbase {

template <class S>
Momentum<S> compute_momentum(const InertiaMatrices<S>& inertia, const TildeInertia<S>& tilde,
                             const Vector6<S>& Omega, const JointVector<S>& phidot) {
  const Vector3<S> omega = Omega.template tail<3>();
  Momentum<S> out;
  out.P = (Omega.template head<3>() + omega.cross(inertia.r_bg)) * inertia.mass;
  out.base = tilde.Htilde_omega * omega;
  out.coupling.setZero();
  for (Eigen::Index k = 0; k < phidot.size(); ++k) {
    out.P += inertia.H_bphi.template block<3, 1>(0, k) * phidot[k];
    out.coupling += tilde.Htilde_omegaphi.col(k) * phidot[k];
  }
  out.L_g = out.base + out.coupling;
  return out;
}

template <class S>
Vector6<S> free_floating_base_velocity(const InertiaMatrices<S>& inertia,
                                       const JointVector<S>& phidot) {
  const TildeInertia<S> tilde = compute_tilde_inertia(inertia);
  Vector3<S> p = Vector3<S>::Zero();
  Vector3<S> omega = Vector3<S>::Zero();
  for (Eigen::Index k = 0; k < phidot.size(); ++k) {
    p += inertia.H_bphi.template block<3, 1>(0, k) * phidot[k];
    omega -= tilde.Htilde_omegaphi.col(k) * phidot[k];
  }
  Matrix3<S> L = tilde.Htilde_omega;
  factorize_cholesky(L);
  solve_cholesky(L, omega);
  Vector6<S> Omega;
  Omega.template tail<3>() = omega;
  Omega.template head<3>() = -p / inertia.mass - omega.cross(inertia.r_bg);
  return Omega;
}

}  // namespace stillbase
