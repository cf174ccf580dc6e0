// The lines of <stillbase/dynamics/inertia_factor.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/inertia_factor.hpp>

#include "dynamics/cholesky.hpp"
#include "dynamics/inertia_kernel.hpp"

namespace stillbase {

/// Factorizes the filled lower triangle of A.
template <class S>
static void factorize_filled(const InertiaMatrices<S>& inertia, const JointVectord& added_inertia,
                             const std::vector<bool>& locked, InertiaFactor<S>& out) {
  const Eigen::Index n = inertia.H_phi.rows();
  out.mass = inertia.mass;
  out.r_bg = inertia.r_bg;
  out.H_vphi = inertia.H_bphi.template topRows<3>();
  for (Eigen::Index k = 0; k < n; ++k) out.L(3 + k, 3 + k) += S(added_inertia[k]);
  for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(locked.size()); ++k) {
    if (!locked[static_cast<std::size_t>(k)]) continue;
    out.locked.set(static_cast<std::size_t>(k));
    for (Eigen::Index i = 0; i < 3 + k; ++i) out.L(3 + k, i) = S(0);
    for (Eigen::Index j = k + 1; j < n; ++j) out.L(3 + j, 3 + k) = S(0);
    out.L(3 + k, 3 + k) = S(1);
  }
  factorize_cholesky(out.L);
}

template <class S>
InertiaFactor<S> factorize_inertia(const InertiaMatrices<S>& inertia,
                                   const JointVectord& added_inertia,
                                   const std::vector<bool>& locked) {
  const Eigen::Index n = inertia.H_phi.rows();
  InertiaFactor<S> out;
  out.L.resize(3 + n, 3 + n);
  out.L.template topLeftCorner<3, 3>() = inertia_about_system_centroid(inertia);
  eliminate_base_translation(
      inertia,
      [&out](Eigen::Index k, const Vector3<S>& column) {
        for (Eigen::Index i = 0; i < 3; ++i) out.L(3 + k, i) = column[i];
      },
      [&out](Eigen::Index j, Eigen::Index k, const S& value) { out.L(3 + j, 3 + k) = value; });
  factorize_filled(inertia, added_inertia, locked, out);
  return out;
}

/// The same where the translation is eliminated already.
template <class S>
InertiaFactor<S> factorize_inertia(const InertiaMatrices<S>& inertia, const TildeInertia<S>& tilde,
                                   const JointVectord& added_inertia,
                                   const std::vector<bool>& locked) {
  const Eigen::Index n = inertia.H_phi.rows();
  InertiaFactor<S> out;
  out.L.resize(3 + n, 3 + n);
  out.L.template topLeftCorner<3, 3>() = tilde.Htilde_omega;
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index i = 0; i < 3; ++i) out.L(3 + k, i) = tilde.Htilde_omegaphi(i, k);
    for (Eigen::Index j = k; j < n; ++j) out.L(3 + j, 3 + k) = tilde.Htilde_phi(j, k);
  }
  factorize_filled(inertia, added_inertia, locked, out);
  return out;
}

/// A right-hand side [F_b; tau] of the inertia matrix on its way to the motion.
template <class S>
struct HalfSolution {
  Vector3<S> f;  ///< linear part of F_b
  /// D^-1 L^-1 of what is left for rotation and joints (3 + n).
  Eigen::Matrix<S, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJointsOf<S> + 3, 1> x;
};

/// See solve_inertia().
template <class S>
HalfSolution<S> solve_inertia_forward(const InertiaFactor<S>& factor, const Vector6<S>& F_b,
                                      const JointVector<S>& tau) {
  const Eigen::Index n = factor.H_vphi.cols();
  HalfSolution<S> out{F_b.template head<3>(), {}};
  const Vector3<S> v_g = out.f * (S(1) / factor.mass);  // of the system centroid
  out.x.resize(3 + n);
  out.x.template head<3>() = F_b.template tail<3>() - factor.r_bg.cross(out.f);
  for (Eigen::Index k = 0; k < n; ++k) {
    out.x[3 + k] = factor.locked[static_cast<std::size_t>(k)]
                       ? S(0)
                       : S(tau[k] - factor.H_vphi.col(k).dot(v_g));
  }
  solve_scaled_cholesky(factor.L, out.x);
  return out;
}

template <class S>
GeneralizedMotion<S> solve_inertia_backward(const InertiaFactor<S>& factor, HalfSolution<S> half) {
  const Eigen::Index n = factor.H_vphi.cols();
  solve_transposed_cholesky(factor.L, half.x);
  GeneralizedMotion<S> out;
  const Vector3<S> omega = half.x.template head<3>();
  out.phidot = half.x.tail(n);
  Vector3<S> p = half.f;
  for (Eigen::Index k = 0; k < n; ++k) p -= factor.H_vphi.col(k) * out.phidot[k];
  out.Omega.template head<3>() = p * (S(1) / factor.mass) - omega.cross(factor.r_bg);
  out.Omega.template tail<3>() = omega;
  return out;
}

template <class S>
GeneralizedMotion<S> solve_inertia(const InertiaFactor<S>& factor, const Vector6<S>& F_b,
                                   const JointVector<S>& tau) {
  return solve_inertia_backward(factor, solve_inertia_forward(factor, F_b, tau));
}

}  // namespace stillbase
