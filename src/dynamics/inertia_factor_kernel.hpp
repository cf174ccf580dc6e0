// The lines of <stillbase/dynamics/inertia_factor.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/inertia_factor.hpp>

#include "dynamics/cholesky.hpp"
#include "dynamics/inertia_kernel.hpp"

namespace stillbase {

template <class S>
InertiaFactor<S> factorize_inertia(const InertiaMatrices<S>& inertia,
                                   const JointVectord& added_inertia,
                                   const std::vector<bool>& locked) {
  const Eigen::Index n = inertia.H_phi.rows();
  InertiaFactor<S> out;
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
GeneralizedMotion<S> solve_inertia(const InertiaFactor<S>& factor, const Vector6<S>& F_b,
                                   const JointVector<S>& tau) {
  const Eigen::Index n = factor.H_vphi.cols();
  const Vector3<S> f = F_b.template head<3>();
  const S inverse_mass = S(1) / factor.mass;
  const Vector3<S> v_g = f * inverse_mass;  // of the system centroid
  Eigen::Matrix<S, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJointsOf<S> + 3, 1> x(3 + n);
  x.template head<3>() = F_b.template tail<3>() - factor.r_bg.cross(f);
  for (Eigen::Index k = 0; k < n; ++k) {
    x[3 + k] = factor.locked[static_cast<std::size_t>(k)]
                   ? S(0)
                   : S(tau[k] - factor.H_vphi.col(k).dot(v_g));
  }
  solve_cholesky(factor.L, x);
  GeneralizedMotion<S> out;
  const Vector3<S> omega = x.template head<3>();
  out.phidot = x.tail(n);
  Vector3<S> p = Vector3<S>::Zero();
  for (Eigen::Index k = 0; k < n; ++k) p += factor.H_vphi.col(k) * x[3 + k];
  out.Omega.template head<3>() = v_g - omega.cross(factor.r_bg) - p * inverse_mass;
  out.Omega.template tail<3>() = omega;
  return out;
}

}  // namespace stillbase
