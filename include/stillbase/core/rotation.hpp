// Rotations and poses. A rotation R_AB maps components in frame B to components in frame A;
// a pose T_AB holds R_AB and the position of B's origin in A.
#pragma once

#include <Eigen/Geometry>

#include <stillbase/core/types.hpp>

namespace stillbase {

/// Cross-product matrix: skew(r) x = r x x.
template <class S>
Matrix3<S> skew(const Vector3<S>& r) {
  Matrix3<S> m;
  m << S(0), -r.z(), r.y(), r.z(), S(0), -r.x(), -r.y(), r.x(), S(0);
  return m;
}

/// A frame B as seen from a frame A: x_A = orientation * x_B + position.
struct Pose {
  Vector3d position = Vector3d::Zero();                             ///< origin of B in A, m
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< R_AB, unit norm

  /// T_AC = T_AB * T_BC.
  Pose operator*(const Pose& other) const;
  /// A point of B in the components of A.
  Vector3d operator*(const Vector3d& point) const;
  /// T_BA.
  Pose inverse() const;
  bool is_finite() const;
};

/// exp of a rotation vector (rad): the rotation by |a| about a.
Eigen::Quaterniond rotation_exp(const Vector3d& a);

/// Rotation vector of q, norm in [0, pi].
Vector3d rotation_log(const Eigen::Quaterniond& q);

/// The shortest rotation that takes one direction to another; neither is zero. Of opposite
/// directions one of the half turns.
Eigen::Quaterniond rotation_between(const Vector3d& from, const Vector3d& to);

/// J_r(a) of SO(3): exp(a + da) = exp(a) exp(J_r(a) da) to first order.
Matrix3d rotation_right_jacobian(const Vector3d& a);

/// Roll-pitch-yaw of URDF: R = Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Quaterniond rotation_rpy(double roll, double pitch, double yaw);

/// x wrapped to (-pi, pi].
double wrap_angle(double x);

}  // namespace stillbase
