// The lines of <stillbase/impact/contact_response.hpp>, for any number type.
#pragma once

#include <stillbase/impact/contact_response.hpp>

#include "dynamics/cholesky.hpp"
#include "dynamics/inertia_factor_kernel.hpp"
#include "impact/gradient_kernel.hpp"
#include "impact/hand_motion_kernel.hpp"

namespace stillbase {

/// The first Rows rows and columns of W_h = J H^-1 J'. With the base translation eliminated,
/// H^-1 is that of A = L D L' and of the mass; so W_h = [E/M, 0; 0, 0] + Z' D^-1 Z.
/// The lower triangle.
/// @param Z the first Rows columns of RigidContact::Z are filled
template <int Rows, class S>
static Eigen::Matrix<S, Rows, Rows> hand_inverse_inertia(const PostureImpact<S>& posture,
                                                         decltype(RigidContact<S>::Z)& Z) {
  using Row = Eigen::Matrix<S, 1, Rows>;
  const InertiaFactor<S>& factor = posture.factor;
  const Eigen::Index n = factor.H_vphi.cols();
  const S inverse_mass = S(1) / factor.mass;
  Z.resize(3 + n, 6);
  Z.template topLeftCorner<3, 3>() = skew<S>(posture.kinematics.r_bh - factor.r_bg);
  if constexpr (Rows == 6) Z.template block<3, 3>(0, 3).setIdentity();
  for (Eigen::Index k = 0; k < n; ++k) {
    const bool moves = !factor.locked[static_cast<std::size_t>(k)];
    for (Eigen::Index i = 0; i < Rows; ++i) {
      Z(3 + k, i) = moves ? posture.jacobian.J_phi(i, k) : S(0);
    }
    for (Eigen::Index i = 0; i < 3 && moves; ++i) {
      Z(3 + k, i) -= factor.H_vphi(i, k) * inverse_mass;
    }
  }
  Eigen::Matrix<S, Rows, Rows> W = Eigen::Matrix<S, Rows, Rows>::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) W(i, i) = inverse_mass;
  cholesky_loops::with_size<S>(3 + n, [&](auto size) {
    for (Eigen::Index k = 0; k < size; ++k) {
      const Row z = Z.row(k).template head<Rows>();
      for (Eigen::Index i = k + 1; i < size; ++i) {
        Z.row(i).template head<Rows>() -= z * factor.L(i, k);
      }
      const Row scaled = z * factor.L(k, k);
      for (Eigen::Index j = 0; j < Rows; ++j) {
        for (Eigen::Index i = j; i < Rows; ++i) W(i, j) += z[i] * scaled[j];
      }
    }
  });
  return W;
}

/// How many components an impulse of the contact has.
inline Eigen::Index impulse_size(ContactLaw law) { return law == ContactLaw::Latch ? 6 : 3; }

/// half += that of J' F, from Z. @param F sticking: without moment
template <class S>
static void push(const PostureImpact<S>& posture, const RigidContact<S>& contact,
                 const Vector6<S>& F, HalfSolution<S>& half) {
  const Eigen::Index columns = impulse_size(contact.law);
  half.f += F.template head<3>();
  for (Eigen::Index k = 0; k < half.x.size(); ++k) {
    S sum = contact.Z(k, 0) * F[0];
    for (Eigen::Index i = 1; i < columns; ++i) sum += contact.Z(k, i) * F[i];
    half.x[k] += sum * posture.factor.L(k, k);
  }
}

/// J x of the motion x that is half solved for; sticking: its linear part.
template <class S>
static Vector6<S> hand_twist(const PostureImpact<S>& posture, const RigidContact<S>& contact,
                             const HalfSolution<S>& half) {
  const Eigen::Index columns = impulse_size(contact.law);
  Vector6<S> out = Vector6<S>::Zero();
  out.template head<3>() = half.f * (S(1) / posture.factor.mass);
  for (Eigen::Index k = 0; k < half.x.size(); ++k) {
    for (Eigen::Index i = 0; i < columns; ++i) out[i] += contact.Z(k, i) * half.x[k];
  }
  return out;
}

/// A += the target's velocity per impulse at the hand, [E/m - skew(r) Q, Q'; Q, I^-1],
/// Q = I^-1 skew(r); the lower triangle. @tparam Rows 3: the linear part
template <int Rows, class S>
static void add_target(const TargetAtHand<S>& target, Eigen::Matrix<S, Rows, Rows>& A) {
  const Matrix3<S> Q = target.inverse_inertia * skew<S>(target.r);
  for (int i = 0; i < 3; ++i) {
    const Vector3<S> q = Q.col(i);
    A.template block<3, 1>(0, i) -= target.r.cross(q);
    A(i, i) += target.inverse_mass;
  }
  if constexpr (Rows == 6) {
    A.template block<3, 3>(3, 0) += Q;
    A.template block<3, 3>(3, 3) += target.inverse_inertia;
  }
}

/// W_t F: change of the target's velocity at the hand by the impulse F there.
template <class S>
static Vector6<S> target_velocity(const TargetAtHand<S>& target, const Vector6<S>& F) {
  const Vector3<S> f = F.template head<3>();
  const Vector3<S> omega = target.inverse_inertia * (target.r.cross(f) + F.template tail<3>());
  Vector6<S> out;
  out.template head<3>() = f * target.inverse_mass + omega.cross(target.r);
  out.template tail<3>() = omega;
  return out;
}

/// Of robot and held target about their common centroid.
template <class S>
struct HeldTarget {
  S mass, reduced_mass;
  Vector3<S> c;  ///< its centroid, in B, m
  Vector3<S> s;  ///< the same from the robot's centroid

  HeldTarget(const PostureImpact<S>& posture, const TargetAtHand<S>& target)
      : mass(S(1) / target.inverse_mass),
        reduced_mass(posture.inertia.mass / (S(1) + posture.inertia.mass * target.inverse_mass)),
        c(posture.kinematics.r_bh - target.r),
        s(c - posture.inertia.r_bg) {}

  /// (I_t + m_r skew(s)' skew(s)) w
  Vector3<S> rotation(const TargetAtHand<S>& target, const Vector3<S>& w) const {
    return target.inertia * w + s.cross(Vector3<S>(w.cross(s))) * reduced_mass;
  }
  /// Velocity of its centroid where it moves with the base by the twist x.
  Vector3<S> velocity(const Vector6<S>& x) const {
    return x.template head<3>() + x.template tail<3>().cross(c);
  }
  /// Momentum [P; L] about the base centroid where it moves with the base by the twist x.
  Vector6<S> momentum(const TargetAtHand<S>& target, const Vector6<S>& x) const {
    Vector6<S> out;
    const Vector3<S> p = velocity(x) * mass;
    out.template head<3>() = p;
    out.template tail<3>() = c.cross(p) + target.inertia * x.template tail<3>();
    return out;
  }
};

/// What decides the motion of a hand that moves.
template <class S>
static HandMatch<S> hand_match(const RigidContact<S>& contact) {
  return {contact.matched, contact.rates, contact.n,
          contact.target.velocity_at_hand() - contact.apart};
}

template <class S>
ImpactResponse<S> respond_to_contact(const PostureImpact<S>& posture, RigidContact<S>& contact) {
  const TargetAtHand<S>& target = contact.target;
  Vector6<S> F = target.velocity_at_hand();
  const bool moves = contact.matched != MatchedPart::None;
  if (moves) {
    contact.before = match_hand<S>(posture, hand_match<S>(contact));
    F -= contact.before.V;
  }
  Matrix6<S>& A = contact.A_factor;
  if (contact.law == ContactLaw::Latch) {
    A = hand_inverse_inertia<6>(posture, contact.Z);
    add_target<6>(target, A);
  } else {
    Matrix3<S> linear = hand_inverse_inertia<3>(posture, contact.Z);
    add_target<3>(target, linear);
    A.setIdentity();
    A.template topLeftCorner<3, 3>() = linear;
    F.template tail<3>().setZero();
  }
  factorize_cholesky(A);
  solve_cholesky(A, F);
  HalfSolution<S> half{Vector3<S>::Zero(), {}};
  half.x.setZero(contact.Z.rows());
  push<S>(posture, contact, F, half);
  const GeneralizedMotion<S> d = solve_inertia_backward(posture.factor, half);
  ImpactResponse<S> out{.F = F,
                        .d = {d.Omega, d.phidot},
                        .total = {},
                        .base = {},
                        .hand_inverse_mass = {},
                        .held_momentum = Vector6<S>::Zero()};
  // F . W_h F, W_h F the velocity of the target after the contact less that of the hand before it.
  Vector6<S> hand_change = target.velocity_at_hand() - target_velocity<S>(target, F);
  if (moves) {
    out.d.Delta_Omega += contact.before.Omega;
    out.d.Delta_phidot += contact.before.phidot;
    hand_change -= contact.before.V;
  }
  out.hand_inverse_mass = F.dot(hand_change);
  out.base = posture.tilde.Htilde_omega * out.omega();
  if (contact.law == ContactLaw::Latch) {
    const HeldTarget<S> held(posture, target);
    out.base += held.rotation(target, out.omega());
    out.total = target.inertia * target.omega + held.s.cross(target.velocity) * held.reduced_mass;
    out.held_momentum = held.momentum(target, out.d.Delta_Omega);
  } else {
    const Vector3<S> r_gh = posture.kinematics.r_bh - posture.inertia.r_bg;
    out.total = r_gh.cross(Vector3<S>(F.template head<3>()));
  }
  return out;
}

/// u x I w + w x I u: derivative of u' I w over a small rotation of B, I fixed in N.
template <class S>
static Vector3<S> turn_of_form(const Matrix3<S>& I, const Vector3<S>& u, const Vector3<S>& w) {
  return u.cross(Vector3<S>(I * w)) + w.cross(Vector3<S>(I * u));
}

template <class S>
ContactGradient<S> motion_before_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                          const RigidContact<S>& contact,
                                          const HandMotionWeights<S>& weights) {
  const HandMatch<S> match = hand_match<S>(contact);
  const auto by_motion = hand_motion_gradient<S>(robot, posture, match, contact.before, weights);
  const Vector3<S> by_v = by_motion.V.template head<3>(), by_w = by_motion.V.template tail<3>();
  ContactGradient<S> out;
  out.phi = by_motion.phi;
  out.velocity = by_v;
  out.omega = by_w + contact.target.r.cross(by_v);
  out.apart = -by_motion.V;
  out.turn = by_v.cross(Vector3<S>(match.V.template head<3>())) +
             by_w.cross(Vector3<S>(match.V.template tail<3>())) + by_motion.n.cross(match.n);
  return out;
}

template <class S>
ContactGradient<S> contact_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                    const RigidContact<S>& contact,
                                    const ImpactResponse<S>& response,
                                    const ResponseWeights<S>& weights) {
  const auto n = static_cast<int>(posture.jacobian.J_phi.cols());
  const bool is_latch = contact.law == ContactLaw::Latch;
  const TargetAtHand<S>& target = contact.target;
  const Vector6<S>& F = response.F;
  ContactGradient<S> out;
  out.phi.setZero(n);
  out.turn.setZero();
  out.velocity.setZero();
  out.omega.setZero();
  out.apart.setZero();

  // What psi changes by where Delta Omega, Delta phidot and F stay.
  Vector6<S> of_target = Vector6<S>::Zero();  // in the adjoint's right-hand side
  Vector6<S> by_F = Vector6<S>::Zero();
  Vector3<S> by_r_gh = Vector3<S>::Zero();
  Vector3<S> by_r_bh = Vector3<S>::Zero();
  by_F.template head<3>() = weights.force;
  if (is_latch) {
    const HeldTarget<S> held(posture, target);
    const Vector3<S> w = response.omega();
    const Vector3<S>&u = weights.base, &u_t = weights.total;
    of_target.template tail<3>() = held.rotation(target, u);
    const Vector3<S> ws = w.cross(held.s), us = u.cross(held.s);
    by_r_gh = (ws.cross(u) + us.cross(w) + target.velocity.cross(u_t)) * held.reduced_mass;
    out.velocity = u_t.cross(held.s) * held.reduced_mass;
    out.omega = target.inertia * u_t;
    out.turn = turn_of_form<S>(target.inertia, u, w) +
               u_t.cross(Vector3<S>(target.inertia * target.omega)) +
               out.velocity.cross(target.velocity);
    const Vector6<S>& U = weights.momentum;
    if (U != Vector6<S>::Zero()) {
      of_target += held.momentum(target, U);
      const Vector6<S>& x = response.d.Delta_Omega;
      const Vector3<S> u_w = U.template tail<3>();
      by_r_bh = (held.velocity(x).cross(u_w) + held.velocity(U).cross(w)) * held.mass;
      for (int k = 0; k < n; ++k) {
        out.phi[k] += posture.jacobian.J_phi.template block<3, 1>(0, k).dot(by_r_bh);
      }
      out.turn += turn_of_form<S>(target.inertia, u_w, w);
    }
    // The centroid is at r_bh - r.
    out.turn -= (by_r_gh + by_r_bh).cross(target.r);
  } else {
    const Vector3<S> r_gh = posture.kinematics.r_bh - posture.inertia.r_bg;
    by_r_gh = F.template head<3>().cross(weights.total);
    by_F.template head<3>() += weights.total.cross(r_gh);
    by_F.template tail<3>() += weights.total;
  }

  // Through Delta Omega and Delta phidot, then through F.
  GeneralizedMotion<S> d{response.d.Delta_Omega, response.d.Delta_phidot};
  const bool moves = contact.matched != MatchedPart::None;
  if (moves) {
    d.Omega -= contact.before.Omega;
    d.phidot -= contact.before.phidot;
  }
  const GeneralizedMotion<S> of_motion =
      weights_of_motion<S>(posture, weights, is_latch ? &of_target : nullptr);
  HalfSolution<S> half = solve_inertia_forward(posture.factor, of_motion.Omega, of_motion.phidot);
  Vector6<S> mu = by_F + hand_twist<S>(posture, contact, half);
  if (!is_latch) mu.template tail<3>().setZero();
  solve_cholesky(contact.A_factor, mu);
  const Vector6<S> minus_mu = -mu;
  push<S>(posture, contact, minus_mu, half);
  const GeneralizedMotion<S> lambda = solve_inertia_backward(posture.factor, half);
  // J d = W_h F, which with the hand's velocity before is the target's after the contact, and
  // J lambda + by_F = W_t mu; of a sticking contact their linear parts, which alone count.
  const Vector6<S> of_mu = target_velocity<S>(target, mu);
  const Vector6<S> after = target.velocity_at_hand() - target_velocity<S>(target, F);
  const Vector6<S> of_lambda = of_mu - by_F;
  Vector6<S> hand_change = after;
  if (moves) hand_change -= contact.before.V;
  const JointAxes<S> axes = joint_axes(robot, posture.kinematics);
  add_motion_gradient<S>(robot, posture, axes, {lambda, minus_mu}, {d, F},
                         cross_by_parts<S>(of_lambda, F) - cross_by_parts<S>(hand_change, mu),
                         out.phi);
  add_explicit_gradient<S>(robot, posture, axes, response, weights, by_r_gh, out.phi);

  // In the axes of the target only W_h turns, and F on its way back to B.
  out.turn += cross_by_parts<S>(mu, after) + cross_by_parts<S>(of_mu, F);
  out.velocity += mu.template head<3>();
  out.omega += mu.template tail<3>() + target.r.cross(Vector3<S>(mu.template head<3>()));
  if (!moves) return out;

  // Through the motion before: as it adds to that after it, and as the hand's velocity.
  const ContactGradient<S> before = motion_before_gradient<S>(
      robot, posture, contact, {of_motion.Omega, of_motion.phidot, minus_mu});
  out.phi += before.phi;
  out.turn += before.turn;
  out.velocity += before.velocity;
  out.omega += before.omega;
  out.apart = before.apart;
  return out;
}

}  // namespace stillbase
