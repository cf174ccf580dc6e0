// The lines of <stillbase/dynamics/jacobian.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/jacobian.hpp>

namespace stillbase {

template <class S>
HandJacobian<S> compute_hand_jacobian(const RobotModel& robot, const Kinematics<S>& kin) {
  HandJacobian<S> out;
  out.R_bh.setIdentity();
  out.R_bh.template topRightCorner<3, 3>() = -skew(kin.r_bh);
  out.J_phi.resize(6, kin.n);
  for (int k = 0; k < kin.n; ++k) {
    const Vector3<S> z = kin.z(k);
    if (!robot.moves_hand[k]) {
      out.J_phi.col(k).setZero();
    } else if (robot.joints[k].is_prismatic()) {
      out.J_phi.template block<3, 1>(0, k) = z;
      out.J_phi.template block<3, 1>(3, k).setZero();
    } else {
      out.J_phi.template block<3, 1>(0, k) = z.cross(kin.r_bh - kin.o[k]);
      out.J_phi.template block<3, 1>(3, k) = z;
    }
  }
  return out;
}

}  // namespace stillbase
