#include "verification/path_motion.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/reference/reference.hpp>

namespace stillbase::verification {

HermiteSegment::HermiteSegment(const Approach& approach, std::size_t i)
    : t0_(approach.times[i]),
      h_(approach.times[i + 1] - approach.times[i]),
      a_(approach.joint_positions[i]),
      b_(approach.joint_velocities[i]) {
  const Eigen::VectorXd step = approach.joint_positions[i + 1] - approach.joint_positions[i];
  const Eigen::VectorXd v1 = approach.joint_velocities[i + 1];
  c_ = (3 * step / h_ - 2 * b_ - v1) / h_;
  d_ = (b_ + v1 - 2 * step / h_) / (h_ * h_);
}

HermiteSegment::Extremes HermiteSegment::extremes() const {
  const Eigen::VectorXd first = position(0), last = position(h_);
  Extremes e{first.cwiseMin(last), first.cwiseMax(last),
             velocity(0).cwiseAbs().cwiseMax(velocity(h_).cwiseAbs()),
             acceleration(0).cwiseAbs().cwiseMax(acceleration(h_).cwiseAbs())};
  for (Eigen::Index k = 0; k < a_.size(); ++k) {
    auto look_at = [&](double s) {
      if (!(s > 0 && s < h_)) return;
      const double phi = position(s)(k);
      e.lowest(k) = std::min(e.lowest(k), phi);
      e.highest(k) = std::max(e.highest(k), phi);
    };
    // velocity b + 2 c s + 3 d s^2 = 0, in the form that does not cancel.
    const double q = -(
        c_(k) + std::copysign(std::sqrt(std::max(0.0, c_(k) * c_(k) - 3 * d_(k) * b_(k))), c_(k)));
    if (d_(k) != 0) look_at(q / (3 * d_(k)));
    if (q != 0) look_at(b_(k) / q);
    if (d_(k) != 0) {
      const double s = -c_(k) / (3 * d_(k));  // acceleration zero: extreme rate
      if (s > 0 && s < h_) e.rate(k) = std::max(e.rate(k), std::abs(velocity(s)(k)));
    }
  }
  return e;
}

Vector6d drifting_base_velocity(const RobotModel& robot, const Eigen::VectorXd& phi,
                                const Eigen::VectorXd& phidot) {
  const reference::Dynamics d = reference::compute(robot, {phi, {}, {}});
  const Vector6d momentum = d.H.topRightCorner(6, phi.size()) * phidot;
  return -reference::solve_definite(d.H.topLeftCorner(6, 6), momentum);
}

namespace {

struct PoseRate {
  Vector3d position;
  Eigen::Vector4d orientation;
};

PoseRate pose_rate(const Pose& pose, const Vector6d& Omega) {
  const Eigen::Quaterniond omega(0, Omega(3), Omega(4), Omega(5));
  return {pose.orientation * Vector3d(Omega.head<3>()), 0.5 * (pose.orientation * omega).coeffs()};
}

Pose moved(Pose pose, const PoseRate& rate, double h) {
  pose.position += h * rate.position;
  pose.orientation.coeffs() += h * rate.orientation;
  return pose;
}

}  // namespace

Pose drifted_base(const RobotModel& robot, const HermiteSegment& segment, double s0, double s1,
                  const Pose& from, double max_travel) {
  const double rate = segment.extremes().rate.maxCoeff();
  // At low rates the travel asks for few steps although the rate changes: at least four.
  const double most = std::max((s1 - s0) * rate / max_travel, 4 * (s1 - s0) / segment.duration());
  const int steps = static_cast<int>(std::clamp(std::ceil(most), 1.0, 1e6));
  const double h = (s1 - s0) / steps;
  auto Omega = [&](double s) {
    return drifting_base_velocity(robot, segment.position(s), segment.velocity(s));
  };
  Pose pose = from;
  Vector6d here = Omega(s0);
  for (int i = 0; i < steps; ++i) {
    const double s = s0 + i * h;
    const Vector6d middle = Omega(s + h / 2), there = Omega(s + h);
    const PoseRate k1 = pose_rate(pose, here);
    const PoseRate k2 = pose_rate(moved(pose, k1, h / 2), middle);
    const PoseRate k3 = pose_rate(moved(pose, k2, h / 2), middle);
    const PoseRate k4 = pose_rate(moved(pose, k3, h), there);
    pose = moved(moved(moved(moved(pose, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
    pose.orientation.normalize();
    here = there;
  }
  return pose;
}

}  // namespace stillbase::verification
