// The laws of <stillbase/simulation/controllers.hpp>, for any number type.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <stillbase/simulation/controllers.hpp>

#include "core/select.hpp"
#include "dynamics/bias_kernel.hpp"
#include "simulation/symmetric_eigen3.hpp"

namespace stillbase {

template <class S>
S momentum_edge(const Controller& controller, const S& sigma_max, const S& L_g) {
  using std::max;
  return max(S(controller.rank_edge) * sigma_max, L_g / S(controller.joint_rate_edge));
}

template <class S>
JointVector<S> MomentumTransfer<S>::joint_rates(const Matrix3X<S>& A, const Vector3<S>& b) const {
  Vector3<S> scaled = Vector3<S>::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vector3<S> direction = U.col(i);
    scaled += direction * (inverse[i] * direction.dot(b));
  }
  JointVector<S> rates(A.cols());
  for (Eigen::Index k = 0; k < A.cols(); ++k) rates[k] = A.col(k).dot(scaled);
  return rates;
}

template <class S>
Vector3<S> MomentumTransfer<S>::unreachable(const Vector3<S>& momentum) const {
  Vector3<S> out = Vector3<S>::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vector3<S> direction = U.col(i);
    out += direction * ((S(1) - share[i]) * direction.dot(momentum));
  }
  return out;
}

/// A A'.
template <class S>
Matrix3<S> square_of(const Matrix3X<S>& A) {
  Matrix3<S> square = Matrix3<S>::Zero();
  for (Eigen::Index k = 0; k < A.cols(); ++k) {
    const S x = A(0, k), y = A(1, k), z = A(2, k);
    square(0, 0) += x * x;
    square(1, 0) += y * x;
    square(2, 0) += z * x;
    square(1, 1) += y * y;
    square(2, 1) += z * y;
    square(2, 2) += z * z;
  }
  square(0, 1) = square(1, 0);
  square(0, 2) = square(2, 0);
  square(1, 2) = square(2, 1);
  return square;
}

template <class S>
MomentumTransfer<S> compute_momentum_transfer(const Controller& controller, const Matrix3X<S>& A,
                                              const Vector3<S>& L_g) {
  using std::max;
  using std::min;
  using std::sqrt;
  // The 3x3 eigenproblem of A A' instead of a singular value decomposition of A: it squares the
  // condition, which is harmless as everything below rank_edge (>> 1e-8) is given up anyway.
  MomentumTransfer<S> out;
  Vector3<S> values;
  descending_eigen3<S>(square_of<S>(A), values, out.U);
  for (Eigen::Index i = 0; i < 3; ++i) out.sigma[i] = sqrt(max(values[i], S(0)));
  const S edge = momentum_edge<S>(controller, out.sigma[0], sqrt(L_g.dot(L_g)));
  const auto is_zero = at_least(S(0), out.sigma[0]);
  out.rank = S(0);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const S ratio = out.sigma[i] / edge;
    const S larger = max(out.sigma[i], edge);
    out.share[i] = where(is_zero, S(0), min(S(1), ratio * ratio));
    out.inverse[i] = where(is_zero, S(0), S(1) / (larger * larger));
    out.rank += where(at_least(out.share[i], S(1)), S(1), S(0));
  }
  return out;
}

/// A symmetric matrix M and the coefficients of its characteristic polynomial.
template <class S>
struct Symmetric3 {
  Matrix3<S> M, adjugate;
  S size, minors, det;  ///< traces of both, determinant

  explicit Symmetric3(const Matrix3<S>& entries) : M(entries) {
    const auto trace = [](const Matrix3<S>& of) { return S(of(0, 0) + of(1, 1) + of(2, 2)); };
    adjugate.col(0) = Vector3<S>(M.col(1)).cross(Vector3<S>(M.col(2)));
    adjugate.col(1) = Vector3<S>(M.col(2)).cross(Vector3<S>(M.col(0)));
    adjugate.col(2) = Vector3<S>(M.col(0)).cross(Vector3<S>(M.col(1)));
    size = trace(M);
    minors = trace(adjugate);
    det = M.col(0).dot(adjugate.col(0));
  }
};

/// The least eigenvalue l of a semidefinite matrix whose others are a and b, by Halley's method,
/// which from 0 on comes to l from below.
template <class S>
struct LeastEigenvalue {
  S l = S(0);
  S sum, product;  ///< of a and b
  S apart;         ///< (a - l) (b - l)
  S certainty;     ///< at least 0 where l is so well apart that its direction is known to 1e-11

  explicit LeastEigenvalue(const Symmetric3<S>& of) {
    using std::abs;
    using std::min;
    constexpr int kSteps = 3;
    // What the last step leaves of the direction is (step size / apart)^3; the rounding of the
    // determinant moves it by (size^2 / apart)^2 times that of a number.
    constexpr double kLastStep = 1e-4, kLeastApart = 1e-2;
    S step(0);
    apart = of.minors;
    for (int i = 0; i < kSteps; ++i) {
      const S value = of.det - ((l - of.size) * l + of.minors) * l;
      step = value * apart / (apart * apart - value * (of.size - S(3) * l));
      l += step;
      apart = (S(3) * l - S(2) * of.size) * l + of.minors;
    }
    sum = of.size - l;
    product = of.minors - l * sum;
    // In this order NaN, of a matrix of rank 1 or 0, stays what it is.
    certainty = min(S(apart - S(kLeastApart) * of.size * of.size),
                    S(S(kLastStep) * apart - abs(step) * of.size));
  }
};

/// U diag(inverse) U' of the momentum transfer: A' times it is A^d. Most often it takes no singular
/// values: no direction is given up, and it is (A A')^-1, or only the one of the least of them.
template <class S>
Matrix3<S> damped_inverse_square(const Controller& controller, const Matrix3X<S>& A,
                                 const Vector3<S>& L_g) {
  using std::max;
  using std::min;
  const Symmetric3<S> square(square_of<S>(A));
  const S size = square.size;
  // As momentum_edge() and compute_momentum_transfer(), in squares, which take no roots.
  const S rank_edge(controller.rank_edge), rate_edge(controller.joint_rate_edge);
  const S of_largest = rank_edge * rank_edge;
  const S of_momentum = L_g.dot(L_g) / (rate_edge * rate_edge);
  const auto edge_of = [&](const S& largest) {
    return S(max(S(of_largest * largest), of_momentum));
  };

  // None is given up. No eigenvalue is below det / minors, as the products of any two of them are
  // parts of minors. The determinant is known to the rounding of size^3. Where A = 0 there is no
  // inverse.
  constexpr double kLeastDeterminant = 1e-6;  // of size^3: the inverse is then known to 1e-11
  constexpr double kLeast = std::numeric_limits<double>::min();
  const S above_edge = square.det - edge_of(size) * square.minors;
  const S above_rounding = square.det - S(kLeastDeterminant) * size * size * size;
  const S all_above = min(above_edge, above_rounding) - S(kLeast);
  const auto is_whole = at_least(all_above, S(0));
  Matrix3<S> out = square.adjugate * (S(1) / square.det);
  if (all_hold(is_whole)) return out;
  const auto replace_unless = [&out](const auto& stays, const Matrix3<S>& other) {
    for (Eigen::Index i = 0; i < 9; ++i) {
      out.data()[i] = where(stays, S(out.data()[i]), S(other.data()[i]));
    }
  };

  // Only l is given up, and the momentum decides where the edge is. N / (a b) with
  // N = (a + b) E - A A' has the inverses of a and b; (adjugate - l N) / apart = u u', with the
  // direction u of l, makes its (a + b - l) / (a b) that of the edge.
  const LeastEigenvalue<S> least(square);
  const S others_above = least.product - of_momentum * least.sum;
  const S edge_known = of_momentum - of_largest * size;
  const S one_below = min(min(least.certainty, others_above), edge_known);
  Matrix3<S> N = -square.M;
  for (Eigen::Index i = 0; i < 3; ++i) N(i, i) += least.sum;
  const S inverse = S(1) / least.product;
  const S added = S(1) / max(least.l, of_momentum) - (least.sum - least.l) * inverse;
  replace_unless(is_whole, N * inverse + (square.adjugate - N * least.l) * S(added / least.apart));
  const auto is_quick = at_least(max(all_above, one_below), S(0));
  if (all_hold(is_quick)) return out;

  Vector3<S> values;
  Matrix3<S> U;
  descending_eigen3<S>(square.M, values, U);
  const S edge = edge_of(values[0]);
  const auto is_zero = at_least(S(0), values[0]);
  Matrix3<S> damped = Matrix3<S>::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vector3<S> direction = U.col(i);
    const S of_direction = where(is_zero, S(0), S(1) / max(values[i], edge));
    damped += direction * Vector3<S>(direction * of_direction).transpose();
  }
  replace_unless(is_quick, damped);
  return out;
}

/// Htilde_omegaphi phidot, (2).
template <class S>
Vector3<S> coupling_momentum(const TildeInertia<S>& tilde, const JointVector<S>& phidot) {
  Vector3<S> out = Vector3<S>::Zero();
  for (Eigen::Index k = 0; k < phidot.size(); ++k) out += tilde.Htilde_omegaphi.col(k) * phidot[k];
  return out;
}

/// (22) and (23) as a joint acceleration, with the moment t_b on the base.
template <class S>
JointVector<S> null_space_acceleration(const Controller& controller, const TildeInertia<S>& tilde,
                                       const TildeBias<S>& bias, const Vector3<S>& omega,
                                       const JointVector<S>& phidot, const Vector3<S>& t_b) {
  const Matrix3X<S>& A = tilde.Htilde_omegaphi;
  const Vector3<S> coupling = coupling_momentum(tilde, phidot);
  const Vector3<S> own = tilde.Htilde_omega * omega;
  const Vector3<S> L_g = own + coupling;
  const Matrix3<S> inverse = damped_inverse_square<S>(controller, A, L_g);
  const S K_phi(controller.kind == ControllerKind::Rns ? 0 : controller.K_phi);
  const Vector3<S> wanted = bias.ctilde_omega - own * S(controller.K_omega) - t_b;
  const Vector3<S> carried = inverse * Vector3<S>(coupling * K_phi - wanted);
  JointVector<S> phiddot(phidot.size());
  for (Eigen::Index k = 0; k < phidot.size(); ++k) {
    phiddot[k] = A.col(k).dot(carried) - K_phi * phidot[k];
  }
  return phiddot;
}

/// The joint torques that give phi'', (18) with the moment t_b on the base:
///   tau = Htilde_phi phi'' + ctilde_phi - Htilde_omegaphi' x,
///   Htilde_omega x = Htilde_omegaphi phi'' + ctilde_omega - t_b,
/// which is Hhat_phi phi'' + chat - H_bphi' H_b^-1 [0; -t_b] without its matrices.
template <class S>
JointVector<S> torque_for(const TildeInertia<S>& tilde, const TildeBias<S>& bias,
                          const JointVector<S>& phiddot, const Vector3<S>& t_b) {
  Vector3<S> x = bias.ctilde_omega - t_b + coupling_momentum(tilde, phiddot);
  Matrix3<S> factor = tilde.Htilde_omega;
  factorize_cholesky(factor);
  solve_cholesky(factor, x);
  JointVector<S> tau = bias.ctilde_phi;
  for (Eigen::Index k = 0; k < phiddot.size(); ++k) {
    tau[k] -= tilde.Htilde_omegaphi.col(k).dot(x);
    for (Eigen::Index j = 0; j < phiddot.size(); ++j) tau[k] += tilde.Htilde_phi(k, j) * phiddot[j];
  }
  return tau;
}

/// Joint torques (18) for a moment t_b on the base; of `detumble` those that stop the joints alone.
/// @param terms with members `inertia` and `bias`
template <class S, class Terms>
JointVector<S> joint_torque(const Controller& controller, const Terms& terms,
                            const TildeInertia<S>& tilde, const Vector3<S>& omega,
                            const JointVector<S>& phidot, const Vector3<S>& t_b) {
  const Eigen::Index n = phidot.size();
  JointVector<S> phiddot(n);
  for (Eigen::Index k = 0; k < n; ++k) phiddot[k] = S(0);
  if (controller.kind == ControllerKind::None) return phiddot;
  const TildeBias<S> bias = compute_tilde_bias<S>(terms.inertia, terms.bias);
  if (controller.kind == ControllerKind::JointDampingLiteral) {
    const Vector3<S> no_moment = Vector3<S>::Zero();
    JointVector<S> tau = torque_for<S>(tilde, bias, phiddot, no_moment);
    for (Eigen::Index k = 0; k < n; ++k) tau[k] -= S(controller.K_phi) * phidot[k];
    return tau;
  }
  if (is_reaction_null_space_control(controller.kind)) {
    phiddot = null_space_acceleration<S>(controller, tilde, bias, omega, phidot, t_b);
  } else {
    for (Eigen::Index k = 0; k < n; ++k) phiddot[k] = -S(controller.K_phi) * phidot[k];
  }
  return torque_for<S>(tilde, bias, phiddot, t_b);
}

/// The torque that the friction of joint k takes.
template <class S>
S compensated_friction(const Controller& controller, const Joint& joint, const S& rate) {
  using std::tanh;
  S torque = S(joint.viscous_friction) * rate;
  if (joint.coulomb_friction != 0) {
    torque += S(joint.coulomb_friction) * tanh(rate / S(controller.friction_transition_rate));
  }
  return torque;
}

/// The part of a torque that a joint gives.
/// @param torque_limit whether it is clipped at max_effort
/// @param rate_limit whether a joint at its largest rate gives none in that direction
template <class S>
S limited_torque(const Joint& joint, bool torque_limit, bool rate_limit, const S& rate,
                 const S& tau) {
  using std::abs;
  using std::max;
  using std::min;
  S out = tau;
  if (rate_limit) {
    const auto keeps = at_least(S(0), tau * rate);
    out = where(at_least(abs(rate), S(joint.max_velocity)), where(keeps, tau, S(0)), tau);
  }
  // In this order NaN stays what it is.
  if (torque_limit) out = max(min(out, S(joint.max_effort)), S(-joint.max_effort));
  return out;
}

/// L_g' C^-1 L_g with the covariance C of what sensors measure of an angular momentum,
/// sigma_base^2 Htilde_omega Htilde_omega' + sigma_joint^2 Htilde_omegaphi Htilde_omegaphi'. Up to
/// one they do not tell it from none.
template <class S>
S momentum_in_deviations(const SensorSpec& sensors, const TildeInertia<S>& tilde,
                         const Vector3<S>& L_g) {
  const S base(sensors.base_rate_error * sensors.base_rate_error);
  const S joints(sensors.joint_rate_error * sensors.joint_rate_error);
  Matrix3<S> C = Matrix3<S>::Zero();
  const auto add = [&C](const S& variance, const auto& columns) {
    for (Eigen::Index k = 0; k < columns.cols(); ++k) {
      const Vector3<S> column = columns.col(k);
      C += column * column.transpose() * variance;
    }
  };
  add(base, tilde.Htilde_omega);
  add(joints, tilde.Htilde_omegaphi);
  Vector3<S> x = L_g;
  factorize_cholesky(C);
  solve_cholesky(C, x);
  return L_g.dot(x);
}

/// Whether the joint's largest torque has cut what was demanded.
inline bool is_cut(const Joint& joint, double demanded, double tau) {
  return tau != demanded && (tau >= joint.max_effort || tau <= -joint.max_effort);
}

}  // namespace stillbase
