#include <stillbase/core/rotation.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>

namespace stillbase {

namespace {

// (t - sin t) / t^3. The closed form loses digits below t of about 0.3, where five terms of the
// series are exact to rounding.
double third_order_sine_remainder(double t) {
  if (std::abs(t) > 0.3) return (t - std::sin(t)) / (t * t * t);
  const double x = t * t;
  return 1.0 / 6 - x * (1.0 / 120 - x * (1.0 / 5040 - x * (1.0 / 362880 - x / 39916800)));
}

// sin(t) / t
double sinc(double t) { return std::abs(t) < 1e-8 ? 1.0 : std::sin(t) / t; }

}  // namespace

Pose Pose::operator*(const Pose& other) const {
  return {orientation * other.position + position, (orientation * other.orientation).normalized()};
}

Vector3d Pose::operator*(const Vector3d& point) const { return orientation * point + position; }

Pose Pose::inverse() const {
  const Eigen::Quaterniond q = orientation.conjugate();
  return {-(q * position), q};
}

bool Pose::is_finite() const { return position.allFinite() && orientation.coeffs().allFinite(); }

Eigen::Quaterniond rotation_exp(const Vector3d& a) {
  const double half_angle = 0.5 * a.norm();
  Eigen::Quaterniond q;
  q.w() = std::cos(half_angle);
  q.vec() = 0.5 * sinc(half_angle) * a;
  return q.normalized();
}

Eigen::Quaterniond rotation_between(const Vector3d& from, const Vector3d& to) {
  // Eigen's FromTwoVectors, with the decomposition that is compiled in linear_algebra.cpp.
  const Vector3d a = from.normalized(), b = to.normalized();
  const double c = b.dot(a);
  Eigen::Quaterniond q;
  if (c < -1 + Eigen::NumTraits<double>::dummy_precision()) {
    // Nearly opposite: about the direction that is normal to both.
    Eigen::MatrixXd both(2, 3);
    both << a.transpose(), b.transpose();
    const Vector3d axis = right_svd(both).V.col(2);
    const double w_squared = (1 + std::max(c, -1.0)) * 0.5;
    q.w() = std::sqrt(w_squared);
    q.vec() = axis * std::sqrt(1 - w_squared);
    return q;
  }
  const double s = std::sqrt((1 + c) * 2), inverse = 1 / s;
  q.vec() = a.cross(b) * inverse;
  q.w() = s * 0.5;
  return q;
}

Vector3d rotation_log(const Eigen::Quaterniond& q) {
  // q and -q are the same rotation: the one with w >= 0 has its half angle in [0, pi/2].
  const double w = std::abs(q.w());
  const Vector3d v = q.w() < 0 ? Vector3d(-q.vec()) : Vector3d(q.vec());
  const double s = v.norm();
  if (s < 1e-12 * w) return 2.0 / w * v;
  return 2.0 * std::atan2(s, w) / s * v;
}

Matrix3d rotation_right_jacobian(const Vector3d& a) {
  const double t = a.norm();
  const double half_sinc = sinc(0.5 * t);
  const Matrix3d A = skew<double>(a);
  return Matrix3d::Identity() - 0.5 * half_sinc * half_sinc * A +
         third_order_sine_remainder(t) * A * A;
}

Eigen::Quaterniond rotation_rpy(double roll, double pitch, double yaw) {
  return Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll, Vector3d::UnitX());
}

double wrap_angle(double x) {
  const double wrapped = std::remainder(x, 2 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

}  // namespace stillbase
