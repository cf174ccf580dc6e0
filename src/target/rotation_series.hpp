// Torque-free rotation near an instant as a power series in time.
#pragma once

#include <Eigen/Geometry>

#include <stillbase/core/types.hpp>

namespace stillbase {

/// Euler parameters q(t) = q_0 + q_1 t + ... of R_NT, from Euler's equations and the kinematics of
/// the rotation, order by order:
///
///   h_0 = R_NT' L,   (k+1) h_{k+1} = sum_j h_j x w_{k-j},   w_k = I^-1 h_k      in T
///                    (k+1) q_{k+1} = 1/2 sum_j q_j * (0, w_{k-j})
///
/// The solutions are elliptic functions without poles within pi/2 of a rotation by the largest
/// rate that the energy allows (|t| < pi / (2 |omega|_max)): what is left out within 0.025 rad on
/// either side is some (0.025 / (pi/2))^10 = 1e-18.
class RotationSeries {
 public:
  /// @param q attitude R_NT at t = 0
  /// @param inverse_inertia I^-1 about the centroid, in T
  /// @param L angular momentum, in N
  RotationSeries(const Eigen::Quaterniond& q, const Matrix3d& inverse_inertia, const Vector3d& L);

  Eigen::Quaterniond at(double t) const {
    Eigen::Vector4d sum = q_.col(kDegree);
    for (int k = kDegree - 1; k >= 0; --k) sum = sum * t + q_.col(k);
    return Eigen::Quaterniond(sum).normalized();
  }

 private:
  static constexpr int kDegree = 9;
  Eigen::Matrix<double, 4, kDegree + 1> q_;  ///< x, y, z, w
};

}  // namespace stillbase
