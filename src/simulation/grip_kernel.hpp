// The lines of <stillbase/simulation/grip.hpp>, for any number type.
#pragma once

#include <stillbase/simulation/grip.hpp>

namespace stillbase {

/// Motion of a point of a body against N, in B axes: derivatives are those of N.
template <class S>
struct PointMotion {
  Vector3<S> omega, acceleration, dot_omega;

  /// The acceleration of the body's point that lies by d beside this one.
  Vector3<S> beside(const Vector3<S>& d) const {
    return acceleration + dot_omega.cross(d) + omega.cross(omega.cross(d));
  }
};

namespace kernel {

/// A point of the body that carries the hand, from the base along the joints. @param at the point
template <class S, class Robot>
PointMotion<S> hand_body_motion(const Robot& robot, const Kinematics<S>& kinematics,
                                const Vector6<S>& Omega, const JointVector<S>& phidot,
                                const Vector6<S>& dot_Omega, const JointVector<S>& phiddot,
                                const Vector3<S>& at) {
  const Vector3<S> v = Omega.template head<3>(), omega = Omega.template tail<3>();
  PointMotion<S> motion{omega, dot_Omega.template head<3>() + omega.cross(v),
                        dot_Omega.template tail<3>()};
  Vector3<S> point = Vector3<S>::Zero();
  for (int k = 0; k < robot.num_bodies(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (!robot.moves_hand[i]) continue;
    const S ratio(robot.is_coupled() ? robot.couplings[i].ratio : 1);
    const S rate = ratio * phidot[robot.coordinate(k)];
    const S change = ratio * phiddot[robot.coordinate(k)];
    const Vector3<S> z = kinematics.z(k);
    const Vector3<S> step = kinematics.o[i] - point;
    motion.acceleration = motion.beside(step);
    point = kinematics.o[i];
    if (robot.tree()[i].is_prismatic()) {
      motion.acceleration += z * change + motion.omega.cross(z) * (S(2) * rate);
    } else {
      motion.dot_omega += z * change + motion.omega.cross(z) * rate;
      motion.omega += z * rate;
    }
  }
  const Vector3<S> last = at - point;
  motion.acceleration = motion.beside(last);
  return motion;
}

/// @param mass, inertia of the held body, about its centroid in its own axes
/// @param position, axes of the body in the hand frame
template <class S, class Robot>
Vector6<S> grip_wrench(const S& mass, const Matrix3<S>& inertia, const Vector3<S>& position,
                       const Matrix3<S>& axes, const Robot& robot, const Kinematics<S>& kinematics,
                       const Vector6<S>& Omega, const JointVector<S>& phidot,
                       const Vector6<S>& dot_Omega, const JointVector<S>& phiddot) {
  const Vector3<S> arm = kinematics.R_hand * position;  // hand to centroid
  const Vector3<S> at = kinematics.r_bh + arm;
  const PointMotion<S> centroid =
      hand_body_motion<S>(robot, kinematics, Omega, phidot, dot_Omega, phiddot, at);
  const Matrix3<S> R = kinematics.R_hand * axes;
  const Matrix3<S> RI = R * inertia;
  const Matrix3<S> I = RI * R.transpose();
  const Vector3<S> f = centroid.acceleration * mass;
  const Vector3<S> spin = I * centroid.omega;
  Vector6<S> wrench;
  wrench.template head<3>() = f;
  wrench.template tail<3>() = I * centroid.dot_omega + centroid.omega.cross(spin) + arm.cross(f);
  return wrench;
}

}  // namespace kernel

}  // namespace stillbase
