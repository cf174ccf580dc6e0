// The lines of <stillbase/dynamics/kinematics.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/kinematics.hpp>

#include <cassert>
#include <cmath>
#include <type_traits>

#include "core/sines.hpp"

namespace stillbase {

template <class S>
void sin_and_cos(const S& x, S& sine, S& cosine) {
  using std::cos;
  using std::sin;
  sine = sin(x);
  cosine = cos(x);
}

// Everywhere in these kernels, a Robot is a RobotModel or has its members as far as they are read:
// robots with mass properties of another number type (simulation/lane_robot.hpp).
namespace kernel {

/// Of the joint that moves body k.
template <class S, class Robot>
S joint_position(const Robot& robot, const JointVector<S>& phi, int k) {
  if (!robot.is_coupled()) return phi[k];
  const Coupling& coupling = robot.couplings[k];
  return phi[coupling.joint] * S(coupling.ratio) + S(coupling.offset);
}

/// The hand's frame, of poses that are known.
template <class S, class Robot>
void place_hand(const Robot& robot, Kinematics<S>& kin) {
  if (robot.hand_body == kBase) {
    kin.R_hand = robot.R_hand.template cast<S>();
    kin.r_bh = robot.p_hand.template cast<S>();
  } else {
    kin.R_hand.noalias() = kin.R[robot.hand_body] * robot.R_hand.template cast<S>();
    kin.r_bh = kin.o[robot.hand_body];
    kin.r_bh.noalias() += kin.R[robot.hand_body] * robot.p_hand.template cast<S>();
  }
}

/// Room for the poses of n bodies.
template <class S>
void make_room(int n, Kinematics<S>& kin) {
  kin.n = n;
  kin.R.resize(n);
  kin.o.resize(n);
  kin.c.resize(n);
}

/// Sines and cosines of the joints' angles, all at once; those of prismatic joints do not count.
struct JointSines {
  BodyWorkspace<double, double> sine, cosine;

  template <class Robot>
  JointSines(const Robot& robot, const JointVectord& phi) {
    static_assert(kMaxJoints % kSinesAtOnce == 0);
    const std::vector<Joint>& tree = robot.tree();
    const int n = robot.num_bodies();
    BodyWorkspace<double, double> angle;
    for (int k = 0; k < n; ++k) {
      angle[k] = tree[k].is_prismatic() ? 0 : joint_position<double>(robot, phi, k);
    }
    for (int k = n; k % kSinesAtOnce != 0; ++k) angle[k] = 0;
    sines_and_cosines(angle.data(), n, sine.data(), cosine.data());
  }
};

template <class S, class Robot>
Kinematics<S> kinematics(const Robot& robot, const JointVector<S>& phi) {
  assert(phi.size() == robot.n());
  Kinematics<S> kin;
  make_room(robot.num_bodies(), kin);
  Matrix3<S>* const R = kin.R.data();
  Vector3<S>* const o = kin.o.data();
  const std::vector<Joint>& tree = robot.tree();
  const auto position = [&robot, &phi](int k) { return joint_position<S>(robot, phi, k); };
  constexpr bool kAllAtOnce = std::is_same_v<S, double>;
  [[maybe_unused]] const auto sines = [&] {
    if constexpr (kAllAtOnce)
      return JointSines(robot, phi);
    else
      return 0;
  }();
  for (int k = 0; k < kin.n; ++k) {
    const Joint& joint = tree[k];
    Matrix3<S> A;
    if (joint.parent == kBase) {
      A = joint.R.matrix().template cast<S>();
      o[k] = joint.p.template cast<S>();
    } else {
      A.noalias() = R[joint.parent] * joint.R.matrix().template cast<S>();
      o[k] = o[joint.parent];
      o[k].noalias() += R[joint.parent] * joint.p.template cast<S>();
    }
    if (joint.is_prismatic()) {
      R[k] = A;
      o[k] += A.col(2) * position(k);
    } else {
      S s, c;
      if constexpr (kAllAtOnce) {
        s = sines.sine[k];
        c = sines.cosine[k];
      } else {
        sin_and_cos(position(k), s, c);
      }
      R[k].col(0) = A.col(0) * c + A.col(1) * s;
      R[k].col(1) = A.col(1) * c - A.col(0) * s;
      R[k].col(2) = A.col(2);
    }
    kin.c[k] = o[k];
    kin.c[k].noalias() += R[k] * robot.bodies[k].centroid.template cast<S>();
  }
  place_hand(robot, kin);
  return kin;
}

}  // namespace kernel

template <class S>
Kinematics<S> compute_kinematics(const RobotModel& robot, const JointVector<S>& phi) {
  return kernel::kinematics<S>(robot, phi);
}

}  // namespace stillbase
