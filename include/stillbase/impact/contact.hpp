// Contact laws: how large the impulse is (PHYSICS: given, point mass, rigid body).
//
// n is the direction of the impulse on the hand = the target's outward normal at the contact; the
// closing speed is v_n = n . (v_target - v_hand) > 0. Bodies that separate exchange no impulse.
#pragma once

#include <stillbase/core/types.hpp>

namespace stillbase {

/// Contact of hand and target in a simulation.
enum class ContactModel {
  Jump,       ///< the instantaneous impact of the contact law
  Compliant,  ///< spring-damper and Coulomb friction over a finite time, both bodies moving
  Latch       ///< a grasp that closes at once; the target stays attached
};

/// Frictionless impact along n: p = (1+e) v_n / (n' W_h n + n' W_t n); 0 when v_n <= 0.
/// @param restitution e in [0, 1]
double normal_impulse(double restitution, double closing_speed, double hand_inverse_mass,
                      double target_inverse_mass);

}  // namespace stillbase
