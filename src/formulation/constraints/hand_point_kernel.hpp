// Where the hand is and where it must be, for the constraints on the hand's point.
#pragma once

#include "formulation/constraints/constraint.hpp"

namespace stillbase {

/// Whether the problem says where the hand must be.
inline bool has_hand_point(const CaptureModel& model) {
  return model.encounter.hand_point || model.encounter.hand_follows_target();
}

/// The point in its own frame: N, or B where it is stated there.
template <class S>
Vector3<S> wanted_hand_point(const ConstraintPoint<S>& at) {
  const std::optional<Vector3d>& stated = at.model.encounter.hand_point;
  return stated ? Vector3<S>(stated->cast<S>()) : at.placement.contact.point;
}

/// gradient += sign * d/dx of component i in N of the hand's position from the base, minus that of
/// the wanted point.
template <class S>
void add_hand_point_gradient(const ConstraintPoint<S>& at, int i, const S& sign,
                             ScalarGradient<S>& gradient) {
  const Vector3<S> axis = at.placement.R_NB.row(i).transpose();
  for (int k = 0; k < at.model.n(); ++k) {
    const Vector3<S> column = at.posture.jacobian.J_phi.template block<3, 1>(0, k);
    gradient.phi[k] = sign * axis.dot(column);
  }
  gradient.theta = at.posture.kinematics.r_bh.cross(axis) * sign;
  if (!at.model.encounter.hand_point) gradient.t = -sign * at.placement.rates.point[i];
}

}  // namespace stillbase
