// Contact laws: how large the impulse is (PHYSICS: given, point mass, rigid body).
//
// n is the direction of the impulse on the hand = the target's outward normal at the contact; the
// closing speed is v_n = n . (v_target - v_hand) > 0. Bodies that separate exchange no impulse.
#pragma once

#include <stillbase/core/types.hpp>

namespace stillbase {

/// What the impulse of a contact makes of the relative velocity of hand and target.
enum class ContactLaw {
  Frictionless,  ///< along n only, Newton's restitution
  Sticking,      ///< no slip, e = 0, no moment: both contact points move on together
  Latch          ///< all six relative velocities become zero: a grasp that closes at once
};

/// How the hand moves right before the contact, the robot being without momentum.
enum class HandVelocity {
  Rest,         ///< not at all: it waits
  MatchNormal,  ///< as the target's point does along the normal
  MatchLinear,  ///< as the target's point does
  MatchAll,     ///< as the target's point does, with the target's angular velocity
  Stated        ///< the target's velocity seen from the hand is stated
};

/// Which of the joint rates that move the hand so.
enum class ArrivalRates {
  LeastJointRate,  ///< least |phidot|
  LeastBaseRate    ///< least |omega|^2 + kJointRateWeight |phidot|^2, omega of the base
};

/// A hundredth of a joint's rate counts as much as the base's: small, so that the self-motion
/// serves the base, and positive, so that the rates are unique where it leaves more freedom.
inline constexpr double kJointRateWeight = 1e-4;

/// How a simulation resolves the contact of hand and target.
enum class ContactModel {
  Instantaneous,  ///< the impact of the contact law; after a latch the target stays attached
  Compliant       ///< Frictionless: spring-damper and Coulomb friction over a finite time
};

/// Frictionless impact along n: p = (1+e) v_n / (n' W_h n + n' W_t n); 0 when v_n <= 0.
/// @param restitution e in [0, 1]
double normal_impulse(double restitution, double closing_speed, double hand_inverse_mass,
                      double target_inverse_mass);

}  // namespace stillbase
