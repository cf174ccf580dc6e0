#include "target/rotation_series.hpp"

#include <array>

namespace stillbase {

RotationSeries::RotationSeries(const Eigen::Quaterniond& q, const Matrix3d& inverse_inertia,
                               const Vector3d& L) {
  std::array<Vector3d, kDegree> w, h;  // angular velocity, angular momentum; in T
  h[0] = q.conjugate() * L;
  w[0] = inverse_inertia * h[0];
  q_.col(0) = q.coeffs();
  for (int k = 0; k < kDegree; ++k) {
    Eigen::Vector4d turned = Eigen::Vector4d::Zero();
    for (int j = 0; j <= k; ++j) {
      const Eigen::Quaterniond part(Eigen::Vector4d(q_.col(j)));
      const Vector3d& rate = w[static_cast<std::size_t>(k - j)];
      turned += (part * Eigen::Quaterniond(0, rate.x(), rate.y(), rate.z())).coeffs();
    }
    q_.col(k + 1) = turned / (2 * (k + 1));
    if (k + 1 == kDegree) break;
    Vector3d torque = Vector3d::Zero();
    for (int j = 0; j <= k; ++j) {
      torque += h[static_cast<std::size_t>(j)].cross(w[static_cast<std::size_t>(k - j)]);
    }
    const auto next = static_cast<std::size_t>(k) + 1;
    h[next] = torque / (k + 1);
    w[next] = inverse_inertia * h[next];
  }
}

}  // namespace stillbase
