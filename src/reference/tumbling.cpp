#include "reference/tumbling.hpp"

#include <array>
#include <cmath>

#include <Eigen/Dense>

namespace stillbase::reference {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

// Rotation per step, rad. The rates are elliptic functions with poles at least pi/2 away in units
// of the largest rate: terms fall by 0.4 / 1.57 each, and 27 of them reach 1e-16.
constexpr double kAnglePerStep = 0.4;
constexpr int kTerms = 28;

/// q p of quaternions [x y z w].
Vector4d product(const Vector4d& q, const Vector4d& p) {
  Vector4d out;
  out << q[3] * p.head<3>() + p[3] * q.head<3>() + q.head<3>().cross(p.head<3>()),
      q[3] * p[3] - q.head<3>().dot(p.head<3>());
  return out;
}

/// Series of the rate and the attitude about one instant, summed at dt.
Tumbling step(const Matrix3d& inertia, const Matrix3d& inverse, const Tumbling& from, double dt) {
  std::array<Vector3d, kTerms> omega, momentum;  // coefficients times dt^k
  std::array<Vector4d, kTerms> q;
  omega[0] = from.omega;
  q[0] = from.R_NT.coeffs();
  Vector3d omega_sum = omega[0];
  Vector4d q_sum = q[0];
  for (std::size_t k = 0; k + 1 < kTerms; ++k) {
    momentum[k] = inertia * omega[k];
    Vector3d torque = Vector3d::Zero();
    Vector4d rate = Vector4d::Zero();
    for (std::size_t i = 0; i <= k; ++i) {
      torque += momentum[i].cross(omega[k - i]);
      Vector4d w;
      w << omega[k - i], 0;
      rate += product(q[i], w);
    }
    const double scale = dt / static_cast<double>(k + 1);
    omega[k + 1] = scale * (inverse * torque);
    q[k + 1] = scale / 2 * rate;
    omega_sum += omega[k + 1];
    q_sum += q[k + 1];
  }
  Tumbling out{Quaterniond(q_sum), omega_sum};
  out.R_NT.normalize();
  return out;
}

}  // namespace

std::optional<Tumbling> tumble(const Matrix3d& inertia, const Tumbling& from, double duration,
                               const StopCondition& stop) {
  // |omega| is at most what the energy allows about the axis of least inertia.
  const Vector3d moments = Eigen::SelfAdjointEigenSolver<Matrix3d>(inertia).eigenvalues();
  const double rate = std::sqrt(from.omega.dot(inertia * from.omega) / moments[0]);
  const double count = std::max(1.0, std::ceil(std::abs(duration) * rate / kAnglePerStep));
  const Matrix3d inverse = inertia.inverse();
  Tumbling now = from;
  double done = 0;
  while (done < count) {
    if (std::fmod(done, 1024) == 0 && stop.reached()) return std::nullopt;
    now = step(inertia, inverse, now, duration / count);
    ++done;
  }
  return now;
}

}  // namespace stillbase::reference
