// Poses of all bodies in the base frame B, at one posture.
#pragma once

#include <array>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// PerBody within a function: room on the stack for the largest robot, not initialised. The
/// compiler knows where the elements are; for PerBody it reads their address before every access.
template <class T, class S>
using BodyWorkspace = std::array<T, static_cast<std::size_t>(kMaxJointsOf<S>)>;

/// Where everything is at joint positions phi, in B.
template <class S>
struct Kinematics {
  int n = 0;                 ///< bodies: as many as joints unless some follow others
  PerBody<Matrix3<S>, S> R;  ///< axes of body k in B; column 2 is the axis z_k of joint k
  PerBody<Vector3<S>, S> o;  ///< origin of body k (on the axis of joint k) in B, m
  PerBody<Vector3<S>, S> c;  ///< centroid of body k in B, m
  Matrix3<S> R_hand;         ///< axes of the hand frame in B
  Vector3<S> r_bh;           ///< hand, from the base centroid, in B, m

  auto z(int k) const { return R[static_cast<std::size_t>(k)].col(2); }
};

/// Forward kinematics: T_Bk = T_Bparent * (R_k, p_k) * joint(phi_k).
/// @param phi joint positions (n), rad or m; finite
template <class S>
Kinematics<S> compute_kinematics(const RobotModel& robot, const JointVector<S>& phi);
template <>
Kinematics<double> compute_kinematics(const RobotModel& robot, const JointVectord& phi);

}  // namespace stillbase
