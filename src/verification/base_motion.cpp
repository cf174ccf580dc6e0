#include "verification/base_motion.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/reference/reference.hpp>

namespace stillbase::verification {

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
  // Near rest few steps would do by travel, but the rate changes: at least four per segment.
  const double most = std::max((s1 - s0) * rate / max_travel, 4 * (s1 - s0) / segment.duration());
  const int steps = std::max(1, static_cast<int>(std::ceil(most)));
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
