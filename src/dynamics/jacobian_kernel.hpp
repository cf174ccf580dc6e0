// The lines of <stillbase/dynamics/jacobian.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/jacobian.hpp>

namespace stillbase {

template <class S>
HandJacobian<S> compute_hand_jacobian(const RobotModel& robot, const Kinematics<S>& kin) {
  HandJacobian<S> out;
  out.R_bh.setIdentity();
  out.R_bh.template topRightCorner<3, 3>() = -skew(kin.r_bh);
  const std::vector<Joint>& tree = robot.tree();
  out.J_phi.resize(6, robot.n());
  if (robot.is_coupled()) {
    out.J_phi.setZero();
    for (int k = robot.hand_body; k != kBase; k = tree[k].parent) {
      const Coupling& coupling = robot.couplings[k];
      const Vector3<S> z = kin.z(k) * S(coupling.ratio);
      if (tree[k].is_prismatic()) {
        out.J_phi.template block<3, 1>(0, coupling.joint) += z;
      } else {
        out.J_phi.template block<3, 1>(0, coupling.joint) += z.cross(kin.r_bh - kin.o[k]);
        out.J_phi.template block<3, 1>(3, coupling.joint) += z;
      }
    }
    return out;
  }
  for (int k = 0; k < kin.n; ++k) {
    const Vector3<S> z = kin.z(k);
    if (!robot.moves_hand[k]) {
      out.J_phi.col(k).setZero();
    } else if (tree[k].is_prismatic()) {
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
