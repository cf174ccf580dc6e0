// The equations of the hand's axes, for any number type.
#pragma once

#include "proof/encounter_kernel.hpp"

namespace stillbase::proof {

/// Component of the approach axis along a direction of E.
template <class S>
S axis_along(const VariableEncounter& encounter, const EncounterRange<S>& at,
             const Matrix3<S>& R_hand, const Vector3d& direction) {
  const Vector3<S> a = R_hand * Vector3<S>(encounter.approach_axis.cast<S>());
  return Vector3<S>(at.R_BE() * Vector3<S>(direction.cast<S>())).dot(a);
}

/// Component of sum r_i x d_i, r_i the hand's axes and d_i the wanted ones.
template <class S>
S axes_error(const VariableEncounter& encounter, const EncounterRange<S>& at,
             const Matrix3<S>& R_hand, int index) {
  const Matrix3<S> wanted = wanted_hand_axes<S>(encounter, at.R_NB, at.contact.R_EB);
  const int j = (index + 1) % 3, k = (index + 2) % 3;
  S value(0.0);
  for (int i = 0; i < 3; ++i) value += R_hand(j, i) * wanted(k, i) - R_hand(k, i) * wanted(j, i);
  return value;
}

}  // namespace stillbase::proof
