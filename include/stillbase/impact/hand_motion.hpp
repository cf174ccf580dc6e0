// The motion of a robot without momentum whose hand moves as wanted, right before a contact.
//
// With Omega = B phidot, B = -H_b^-1 H_bphi, the hand moves with V = Jhat_phi phidot. Of V a part
// P V is decided (P: the normal, the three linear, the three angular or all six components), and
// among the joint rates that give it those with the least phidot' Q phidot are taken, Q = 1 or
// B_omega' B_omega + kJointRateWeight:
//   phidot = Q^-1 G' mu,  mu = (G Q^-1 G')^-1 P V,  G = P Jhat_phi.
//
// The derivative of any psi(phidot, Omega, V) takes two sweeps: with w = dpsi/dphidot in all,
// kappa = (G Q^-1 G')^-1 G Q^-1 w and a = Q^-1 (w - G' kappa),
//   dpsi = explicit part + mu' dG a - kappa' dG phidot - a' dQ phidot + kappa' d(P V),
// sums of the bilinear forms y' dJhat x and u' dB x (zero_momentum_gradient()).
//
// Assumptions: the base floats; the part has full rank. Where it loses it the rates grow beyond all
// bounds: limits of the rates keep away from there.
#pragma once

#include <stillbase/impact/contact.hpp>
#include <stillbase/impact/gradient.hpp>

namespace stillbase {

/// The decided part of a hand's velocity.
enum class MatchedPart { None, Normal, Linear, Angular, All };
/// Number of its components.
int matched_components(MatchedPart part);

/// What decides it.
template <class S>
struct HandMatch {
  MatchedPart part = MatchedPart::All;  ///< not None
  ArrivalRates rates = ArrivalRates::LeastJointRate;
  Vector3<S> n;  ///< Normal: unit, in B
  Vector6<S> V;  ///< velocity of the hand that is wanted, [v; omega] in B; the part of it counts
};

template <class S>
struct HandMotion {
  Vector6<S> Omega;       ///< of the base, [v; omega] in B
  JointVector<S> phidot;  ///< n
  Vector6<S> V;           ///< of the hand, [v; omega] in B

  // Kept for the gradient.
  Matrix6X<S> base, hand;   ///< Omega = base phidot, V = hand phidot
  Matrix3<S> omega_factor;  ///< of kJointRateWeight + B_omega B_omega'
  Matrix6<S> factor;        ///< of G Q^-1 G'; rows and columns that do not count are those of 1
  Vector6<S> mu;
};

template <class S>
HandMotion<S> match_hand(const PostureImpact<S>& posture, const HandMatch<S>& match);

/// Weights of psi = u_Omega . Omega + u_phidot . phidot + u_V . V.
template <class S>
struct HandMotionWeights {
  Vector6<S> Omega = Vector6<S>::Zero();
  JointVector<S> phidot;  ///< n, or empty
  Vector6<S> V = Vector6<S>::Zero();
};

template <class S>
struct HandMotionGradient {
  JointVector<S> phi;  ///< over the joints (n), n and V wanted fixed in B
  Vector6<S> V;        ///< over the velocity that is wanted
  Vector3<S> n;        ///< over the normal
};

/// @param motion of match_hand()
template <class S>
HandMotionGradient<S> hand_motion_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                           const HandMatch<S>& match, const HandMotion<S>& motion,
                                           const HandMotionWeights<S>& weights);

}  // namespace stillbase
