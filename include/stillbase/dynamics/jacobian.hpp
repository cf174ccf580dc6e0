// Velocity of the hand from base velocity and joint rates, equation (3), in B.
#pragma once

#include <stillbase/dynamics/kinematics.hpp>

namespace stillbase {

/// Hand velocity [v_h; omega_h] = R_bh Omega + J_phi phidot, (3).
template <class S>
struct HandJacobian {
  Matrix6<S> R_bh;    ///< 6x6 shift [E, -skew(r_bh); 0, E]; its transpose stands in (3)
  Matrix6X<S> J_phi;  ///< fixed-base Jacobian, 6 x n

  /// Hand, from the base centroid, in B, m.
  Vector3<S> r_bh() const { return {R_bh(1, 5), R_bh(2, 3), R_bh(0, 4)}; }
};

template <class S>
HandJacobian<S> compute_hand_jacobian(const RobotModel& robot, const Kinematics<S>& kinematics);

}  // namespace stillbase
