#include "verification/path_motion.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "verification/recomputation.hpp"

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
  Extremes e{first.cwiseMin(last), first.cwiseMax(last), peak_rates(0, h_),
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
  }
  return e;
}

Eigen::VectorXd HermiteSegment::peak_rates(double s0, double s1) const {
  Eigen::VectorXd rates = velocity(s0).cwiseAbs().cwiseMax(velocity(s1).cwiseAbs());
  for (Eigen::Index k = 0; k < rates.size(); ++k) {
    if (d_(k) == 0) continue;
    const double s = -c_(k) / (3 * d_(k));  // acceleration zero: extreme rate
    if (s > s0 && s < s1) {
      rates(k) = std::max(rates(k), std::abs(b_(k) + s * (2 * c_(k) + 3 * s * d_(k))));
    }
  }
  return rates;
}

Eigen::MatrixXd base_response(const RobotModel& robot, const Eigen::VectorXd& phi) {
  return base_response(reference::compute(robot, {phi, {}, {}}));
}

Vector6d drifting_base_velocity(const RobotModel& robot, const Eigen::VectorXd& phi,
                                const Eigen::VectorXd& phidot) {
  return base_response(robot, phi) * phidot;
}

namespace {

struct PoseRate {
  Vector3d position;
  Eigen::Vector4d orientation;
};

/// Integration steps of a segment, and what lies between them.
struct BaseTrackOptions {
  double fewest_steps = 4;  ///< at low rates the travel asks for few although the rate changes
  double most_steps = 1e4;  ///< 50 rad at 0.005 rad
  double between = 1.1;     ///< of the largest response at steps, for those between them
};
constexpr BaseTrackOptions kBaseTrack;

PoseRate pose_rate(const Pose& pose, const Vector6d& Omega) {
  const Eigen::Quaterniond omega(0, Omega(3), Omega(4), Omega(5));
  return {pose.orientation * Vector3d(Omega.head<3>()), 0.5 * (pose.orientation * omega).coeffs()};
}

Pose moved(Pose pose, const PoseRate& rate, double h) {
  pose.position += h * rate.position;
  pose.orientation.coeffs() += h * rate.orientation;
  return pose;
}

/// The cubic at u in [0, 1] between two values whose derivatives by u are given.
template <class Vector>
Vector cubic(const Vector& a, const Vector& da, const Vector& b, const Vector& db, double u) {
  const double v = 1 - u;
  return v * v * ((1 + 2 * u) * a + u * da) + u * u * ((1 + 2 * v) * b - v * db);
}

}  // namespace

BaseTrack::BaseTrack(const HermiteSegment& segment, const Pose& held)
    : step_(segment.duration()),
      nodes_(2, {held, Vector3d::Zero(), Eigen::Vector4d::Zero(),
                 Eigen::Matrix2Xd::Zero(2, segment.position(0).size())}) {}

BaseTrack::BaseTrack(const RobotModel& robot, const HermiteSegment& segment, const Pose& from,
                     double max_travel) {
  const double rate = segment.extremes().rate.maxCoeff();
  const double most = std::max(segment.duration() * rate / max_travel, kBaseTrack.fewest_steps);
  if (!(most <= kBaseTrack.most_steps)) {
    throw std::invalid_argument("joints move too far between two samples: no base motion follows");
  }
  const int steps = static_cast<int>(std::ceil(most));
  const double h = step_ = segment.duration() / steps;
  Pose pose = from;
  const auto arrive = [&](const Eigen::MatrixXd& response, const Vector6d& Omega) {
    const PoseRate rates = pose_rate(pose, Omega);
    Eigen::Matrix2Xd norms(2, response.cols());
    norms.row(0) = response.topRows(3).colwise().norm();
    norms.row(1) = response.bottomRows(3).colwise().norm();
    nodes_.push_back({pose, rates.position, rates.orientation, norms});
  };
  const Eigen::MatrixXd first = base_response(robot, segment.position(0));
  Vector6d here = first * segment.velocity(0);
  arrive(first, here);
  for (int i = 0; i < steps; ++i) {
    const double s = i * h;
    const Vector6d middle =
        drifting_base_velocity(robot, segment.position(s + h / 2), segment.velocity(s + h / 2));
    const Eigen::MatrixXd response = base_response(robot, segment.position(s + h));
    const Vector6d there = response * segment.velocity(s + h);
    const PoseRate k1 = pose_rate(pose, here);
    const PoseRate k2 = pose_rate(moved(pose, k1, h / 2), middle);
    const PoseRate k3 = pose_rate(moved(pose, k2, h / 2), middle);
    const PoseRate k4 = pose_rate(moved(pose, k3, h), there);
    pose = moved(moved(moved(moved(pose, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
    pose.orientation.normalize();
    here = there;
    arrive(response, here);
  }
}

double BaseTrack::index(double s) const {
  return std::clamp(s / step_, 0.0, static_cast<double>(nodes_.size() - 1));
}

Pose BaseTrack::pose(double s) const {
  const double i = std::min(std::floor(index(s)), static_cast<double>(nodes_.size() - 2));
  const double u = index(s) - i;
  const Node& a = nodes_[static_cast<std::size_t>(i)];
  const Node& b = nodes_[static_cast<std::size_t>(i) + 1];
  if (u == 0) return a.pose;
  if (u == 1) return b.pose;
  Pose pose;
  pose.position =
      cubic<Vector3d>(a.pose.position, step_ * a.velocity, b.pose.position, step_ * b.velocity, u);
  pose.orientation.coeffs() = cubic<Eigen::Vector4d>(
      a.pose.orientation.coeffs(), step_ * a.spin, b.pose.orientation.coeffs(), step_ * b.spin, u);
  pose.orientation.normalize();
  return pose;
}

BaseTrack::Travel BaseTrack::bound(double s0, double s1, const Eigen::VectorXd& travel) const {
  const auto first = static_cast<std::size_t>(std::floor(index(s0)));
  const auto last = static_cast<std::size_t>(std::ceil(index(s1)));
  Eigen::Matrix2Xd largest = nodes_[first].response;
  for (std::size_t i = first + 1; i <= last; ++i) largest = largest.cwiseMax(nodes_[i].response);
  const Eigen::Vector2d sum = kBaseTrack.between * largest * travel;
  return {sum[0], sum[1]};
}

Pose drifted_base(const RobotModel& robot, const HermiteSegment& segment, const Pose& from,
                  double max_travel) {
  return BaseTrack(robot, segment, from, max_travel).pose(segment.duration());
}

}  // namespace stillbase::verification
