// The lines of <stillbase/impact/hand_motion.hpp>, for any number type.
#pragma once

#include <stillbase/impact/hand_motion.hpp>

#include "dynamics/cholesky.hpp"
#include "impact/gradient_kernel.hpp"

namespace stillbase {

/// The equations of the multipliers have the square of the condition of P Jhat_phi: what a round
/// leaves open the next one solves for. Two would leave 1e-6 of the rates where the least singular
/// value is 1e-6 of the largest.
inline constexpr int kMatchRounds = 4;

/// Whether component i of P V counts.
inline bool counts(MatchedPart part, int i) {
  switch (part) {
    case MatchedPart::None:
      return false;
    case MatchedPart::Normal:
      return i == 0;
    case MatchedPart::Linear:
      return i < 3;
    case MatchedPart::Angular:
      return i >= 3;
    case MatchedPart::All:
      break;
  }
  return true;
}

/// P V, the components that do not count zero.
template <class S>
static Vector6<S> select_part(const HandMatch<S>& match, const Vector6<S>& V) {
  Vector6<S> out = Vector6<S>::Zero();
  if (match.part == MatchedPart::Normal) out[0] = match.n.dot(V.template head<3>());
  if (match.part == MatchedPart::Linear || match.part == MatchedPart::All) {
    out.template head<3>() = V.template head<3>();
  }
  if (match.part == MatchedPart::Angular || match.part == MatchedPart::All) {
    out.template tail<3>() = V.template tail<3>();
  }
  return out;
}

/// P' z.
template <class S>
static Vector6<S> spread_part(const HandMatch<S>& match, const Vector6<S>& z) {
  if (match.part != MatchedPart::Normal) return select_part<S>(match, z);
  Vector6<S> out = Vector6<S>::Zero();
  out.template head<3>() = match.n * z[0];
  return out;
}

/// A' u, A 6 x n.
template <class S>
static JointVector<S> transposed_times(const Matrix6X<S>& A, const Vector6<S>& u) {
  JointVector<S> out(A.cols());
  for (Eigen::Index k = 0; k < A.cols(); ++k) out[k] = A.col(k).dot(u);
  return out;
}

/// A x, A 6 x n.
template <class S>
static Vector6<S> matrix_times(const Matrix6X<S>& A, const JointVector<S>& x) {
  Vector6<S> out = Vector6<S>::Zero();
  for (Eigen::Index k = 0; k < A.cols(); ++k) out += A.col(k) * x[k];
  return out;
}

/// Q^-1 z. Of the base's rate by Woodbury's formula: Q = w + B' B with B = B_omega has
/// Q^-1 = (1 - B' (w + B B')^-1 B) / w.
template <class S>
static JointVector<S> weighted(const HandMatch<S>& match, const HandMotion<S>& motion,
                               const JointVector<S>& z) {
  if (match.rates == ArrivalRates::LeastJointRate) return z;
  Vector3<S> rate = matrix_times<S>(motion.base, z).template tail<3>();
  solve_cholesky(motion.omega_factor, rate);
  Vector6<S> u = Vector6<S>::Zero();
  u.template tail<3>() = rate;
  return (z - transposed_times<S>(motion.base, u)) * S(1 / kJointRateWeight);
}

template <class S>
HandMotion<S> match_hand(const PostureImpact<S>& posture, const HandMatch<S>& match) {
  const Eigen::Index n = posture.jacobian.J_phi.cols();
  const BaseInverse<S> base_inverse(posture);
  HandMotion<S> out;
  out.base.resize(6, n);
  out.hand.resize(6, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Vector6<S> momentum = posture.inertia.H_bphi.col(k);
    out.base.col(k) = -base_inverse(momentum);
    out.hand.col(k) = posture.jacobian.R_bh * out.base.col(k) + posture.jacobian.J_phi.col(k);
  }
  if (match.rates == ArrivalRates::LeastBaseRate) {
    out.omega_factor = Matrix3<S>::Identity() * S(kJointRateWeight);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Vector3<S> b = out.base.col(k).template tail<3>();
      out.omega_factor += b * b.transpose();
    }
    factorize_cholesky(out.omega_factor);
  }
  // G Q^-1 G', column by column.
  for (int i = 0; i < 6; ++i) {
    out.factor.col(i) = Vector6<S>::Unit(i);
    if (!counts(match.part, i)) continue;
    const Vector6<S> row = spread_part<S>(match, Vector6<S>::Unit(i));
    const JointVector<S> rates = weighted<S>(match, out, transposed_times<S>(out.hand, row));
    out.factor.col(i) = select_part<S>(match, matrix_times<S>(out.hand, rates));
  }
  factorize_cholesky(out.factor);
  out.mu.setZero();
  out.phidot = JointVector<S>::Zero(n);
  Vector6<S> open = select_part<S>(match, match.V);
  for (int i = 0; i < kMatchRounds; ++i) {
    solve_cholesky(out.factor, open);
    out.mu += open;
    out.phidot +=
        weighted<S>(match, out, transposed_times<S>(out.hand, spread_part<S>(match, open)));
    out.V = matrix_times<S>(out.hand, out.phidot);
    open = select_part<S>(match, Vector6<S>(match.V - out.V));
  }
  out.Omega = matrix_times<S>(out.base, out.phidot);
  return out;
}

template <class S>
HandMotionGradient<S> hand_motion_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                           const HandMatch<S>& match, const HandMotion<S>& motion,
                                           const HandMotionWeights<S>& weights) {
  JointVector<S> w =
      transposed_times<S>(motion.base, weights.Omega) + transposed_times<S>(motion.hand, weights.V);
  if (weights.phidot.size() == w.size()) w += weights.phidot;
  const JointVector<S> Qw = weighted<S>(match, motion, w);
  Vector6<S> kappa = Vector6<S>::Zero(), by_V = kappa;
  JointVector<S> a = Qw;
  for (int i = 0; i < kMatchRounds; ++i) {
    Vector6<S> open = select_part<S>(match, matrix_times<S>(motion.hand, a));
    solve_cholesky(motion.factor, open);
    kappa += open;
    by_V = spread_part<S>(match, kappa);
    a -= weighted<S>(match, motion, transposed_times<S>(motion.hand, spread_part<S>(match, open)));
  }
  const GeneralizedMotion<S> x{motion.Omega, motion.phidot};
  const GeneralizedMotion<S> x_a{matrix_times<S>(motion.base, a), a};

  Vector6<S> of_x = weights.Omega, of_a = Vector6<S>::Zero();
  if (match.rates == ArrivalRates::LeastBaseRate) {
    of_x.template tail<3>() -= x_a.Omega.template tail<3>();
    of_a.template tail<3>() -= x.Omega.template tail<3>();
  }
  HandMotionGradient<S> out;
  out.phi.setZero(w.size());
  const JointAxes<S> axes = joint_axes(robot, posture.kinematics);
  const Vector6<S> hand_of_x = weights.V - by_V;
  const Vector6<S> hand_of_a = spread_part<S>(match, motion.mu);
  add_zero_momentum_gradient<S>(robot, posture, axes, x, hand_of_x, of_x, out.phi);
  add_zero_momentum_gradient<S>(robot, posture, axes, x_a, hand_of_a, of_a, out.phi);
  out.V = by_V;
  out.n.setZero();
  if (match.part == MatchedPart::Normal) {
    const Vector6<S> V_a = matrix_times<S>(motion.hand, a);
    out.n = V_a.template head<3>() * motion.mu[0] +
            Vector3<S>((match.V - motion.V).template head<3>()) * kappa[0];
  }
  return out;
}

}  // namespace stillbase
