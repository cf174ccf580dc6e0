// The lines of <stillbase/dynamics/kinematics.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/kinematics.hpp>

#include <array>
#include <cassert>
#include <cmath>

namespace stillbase {

/// PerBody within a function: room on the stack for the largest robot, not initialised. The
/// compiler knows where the elements are; for PerBody it reads their address before every access.
template <class T, class S>
using BodyWorkspace = std::array<T, static_cast<std::size_t>(kMaxJointsOf<S>)>;

template <class S>
Kinematics<S> compute_kinematics(const RobotModel& robot, const JointVector<S>& phi) {
  using std::cos;
  using std::sin;
  assert(phi.size() == robot.n());
  Kinematics<S> kin;
  kin.n = robot.n();
  kin.R.resize(kin.n);
  kin.o.resize(kin.n);
  kin.c.resize(kin.n);
  for (int k = 0; k < kin.n; ++k) {
    const Joint& joint = robot.joints[k];
    Matrix3<S> A;
    if (joint.parent == kBase) {
      A = joint.R.template cast<S>();
      kin.o[k] = joint.p.template cast<S>();
    } else {
      A.noalias() = kin.R[joint.parent] * joint.R.template cast<S>();
      kin.o[k] = kin.o[joint.parent];
      kin.o[k].noalias() += kin.R[joint.parent] * joint.p.template cast<S>();
    }
    if (joint.is_prismatic()) {
      kin.R[k] = A;
      kin.o[k] += A.col(2) * phi[k];
    } else {
      const S c = cos(phi[k]);
      const S s = sin(phi[k]);
      kin.R[k].col(0) = A.col(0) * c + A.col(1) * s;
      kin.R[k].col(1) = A.col(1) * c - A.col(0) * s;
      kin.R[k].col(2) = A.col(2);
    }
    kin.c[k] = kin.o[k];
    kin.c[k].noalias() += kin.R[k] * robot.bodies[k].centroid.template cast<S>();
  }
  if (robot.hand_body == kBase) {
    kin.R_hand = robot.R_hand.template cast<S>();
    kin.r_bh = robot.p_hand.template cast<S>();
  } else {
    kin.R_hand.noalias() = kin.R[robot.hand_body] * robot.R_hand.template cast<S>();
    kin.r_bh = kin.o[robot.hand_body];
    kin.r_bh.noalias() += kin.R[robot.hand_body] * robot.p_hand.template cast<S>();
  }
  return kin;
}

}  // namespace stillbase
