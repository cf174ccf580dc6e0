// The lines of <stillbase/dynamics/inertia_factor.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/inertia_factor.hpp>

#include <algorithm>

#include "dynamics/cholesky.hpp"
#include "dynamics/inertia_kernel.hpp"

namespace stillbase {

/// Where the translation is eliminated already.
template <class S>
InertiaFactor<S> factorize_inertia(const InertiaMatrices<S>& inertia, const TildeInertia<S>& tilde,
                                   const JointVectord& added_inertia,
                                   const std::vector<bool>& locked) {
  const Eigen::Index n = inertia.H_phi.rows();
  InertiaFactor<S> out;
  out.mass = inertia.mass;
  out.r_bg = inertia.r_bg;
  out.H_vphi = inertia.H_bphi.template topRows<3>();
  out.L.resize(3 + n, 3 + n);
  const S *const coupling = tilde.Htilde_omegaphi.data(), *const arm = tilde.Htilde_phi.data();
  const auto entry = [&](Eigen::Index i, Eigen::Index j, auto size) __attribute__((always_inline)) {
    if (i < 3) return S(tilde.Htilde_omega(i, j));
    if (j < 3) return S(coupling[j + 3 * (i - 3)]);
    const S& value = arm[(i - 3) + (size - 3) * (j - 3)];
    return i == j ? S(value + S(added_inertia[i - 3])) : S(value);
  };
  const auto is_locked = [&](Eigen::Index i) {
    const auto k = static_cast<std::size_t>(i - 3);
    return i >= 3 && k < locked.size() && locked[k];
  };
  if (std::find(locked.begin(), locked.end(), true) == locked.end()) {
    factorize_cholesky_of(entry, out.L);
    return out;
  }
  for (Eigen::Index j = 0; j < 3 + n; ++j) {
    if (is_locked(j)) out.locked.set(static_cast<std::size_t>(j - 3));
    for (Eigen::Index i = j; i < 3 + n; ++i) {
      out.L(i, j) = is_locked(i) || is_locked(j) ? S(i == j ? 1 : 0) : entry(i, j, 3 + n);
    }
  }
  factorize_cholesky(out.L);
  return out;
}

template <class S>
InertiaFactor<S> factorize_inertia(const InertiaMatrices<S>& inertia,
                                   const JointVectord& added_inertia,
                                   const std::vector<bool>& locked) {
  return factorize_inertia(inertia, compute_tilde_inertia(inertia), added_inertia, locked);
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
