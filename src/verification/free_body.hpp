// A free body's rotation, integrated apart from the planner's.
#pragma once

#include <cmath>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/rotation.hpp>
#include <stillbase/core/types.hpp>
#include <stillbase/target/target.hpp>

namespace stillbase::verification {

struct PrincipalAxes {
  Vector3d moments = Vector3d::Ones();                       ///< kg m^2
  Eigen::Quaterniond R_TP = Eigen::Quaterniond::Identity();  ///< P the principal axes
};
/// @param inertia in T
inline PrincipalAxes principal_axes(const Matrix3d& inertia) {
  const SymmetricEigen3 principal = symmetric_eigen3(inertia);
  Matrix3d axes = principal.vectors;
  if (axes.determinant() < 0) axes.col(2) *= -1;
  return {principal.values, Eigen::Quaterniond(axes)};
}

/// Torque-free rotation by Euler's equations in principal axes, classical Runge-Kutta.
struct FreeBody {
  Vector3d moments;      // kg m^2
  Eigen::Quaterniond q;  // R_NP, P the principal axes
  Vector3d w;            // in P, rad/s

  struct Rate {
    Eigen::Vector4d q;
    Vector3d w;
  };
  Rate rate(const Eigen::Vector4d& e, const Vector3d& v) const {
    const Eigen::Quaterniond spin(0, v[0], v[1], v[2]);
    return {0.5 * (Eigen::Quaterniond(e) * spin).coeffs(),
            moments.cwiseProduct(v).cross(v).cwiseQuotient(moments)};
  }
  /// @param angle of a step, rad
  int steps(double duration, double angle) const {
    // The energy bounds the rate.
    const double fastest =
        std::sqrt(moments.dot(w.cwiseAbs2()) / moments.minCoeff()) * std::abs(duration);
    return 1 + static_cast<int>(fastest / angle);
  }
  void advance(double duration, double angle) {
    const int count = steps(duration, angle);
    const double h = duration / count;
    Eigen::Vector4d e = q.coeffs();
    for (int i = 0; i < count; ++i) {
      const Rate a = rate(e, w);
      const Rate b = rate(e + h / 2 * a.q, w + h / 2 * a.w);
      const Rate c = rate(e + h / 2 * b.q, w + h / 2 * b.w);
      const Rate d = rate(e + h * c.q, w + h * c.w);
      e += h / 6 * (a.q + 2 * b.q + 2 * c.q + d.q);
      w += h / 6 * (a.w + 2 * b.w + 2 * c.w + d.w);
      e.normalize();
    }
    q = Eigen::Quaterniond(e);
  }
};

/// The body of an estimate with errors: of its attitude a rotation vector in N, rad, of its angular
/// velocity in N, rad/s, and of its principal moments their logarithms.
inline FreeBody erroneous_body(const PrincipalAxes& axes, const TargetState& estimate,
                               const Vector3d& orientation, const Vector3d& rate,
                               const Vector3d& moments) {
  FreeBody body{axes.moments.cwiseProduct(moments.array().exp().matrix()),
                estimate.pose.orientation * rotation_exp(orientation) * axes.R_TP,
                Vector3d::Zero()};
  body.w = body.q.conjugate() * (estimate.angular_velocity + rate);
  return body;
}

}  // namespace stillbase::verification
