#include "audit/free_variables.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>

namespace stillbase::audit {
namespace {

/// Candidates satisfy their constraints to 1e-9; distinct solutions are further apart than this.
constexpr double kNear = 1e-6;      ///< rad, m
constexpr double kNearTime = 1e-5;  ///< s: targets are slow

double wrapped(double angle) { return std::remainder(angle, 2 * kPi); }

double beyond(double apart, const double lower, const double upper) {
  return std::abs(apart) - (upper - lower) / 2;
}

}  // namespace

FreeVariables::FreeVariables(const CaptureProblem& problem) : problem_(problem) {
  const VariableSpec& variables = problem.variables;
  std::vector<double> low, high;
  const double margin = problem.constraints.joint_limit_margin;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    if (!variables.joints[k]) continue;
    const bool wraps = joint.type == JointType::Continuous;
    joints_.push_back(k);
    wraps_.push_back(wraps);
    low.push_back(wraps ? -kPi : joint.lower + margin);
    high.push_back(wraps ? kPi : joint.upper - margin);
  }
  has_angle_ = variables.base_attitude == AttitudeFreedom::Axis;
  if (has_angle_) {
    const double most = std::min(variables.base_attitude_max, kPi);
    wraps_.push_back(most == kPi);
    low.push_back(-most);
    high.push_back(most);
  }
  if (variables.base_attitude == AttitudeFreedom::Cone ||
      variables.base_attitude == AttitudeFreedom::Free) {
    vector_ = static_cast<int>(low.size());
    wraps_.insert(wraps_.end(), 3, false);
    low.insert(low.end(), 3, -kPi);
    high.insert(high.end(), 3, kPi);
  }
  has_time_ = variables.contact_time_upper > variables.contact_time_lower;
  if (has_time_) {
    time_unit_ = (variables.contact_time_upper - variables.contact_time_lower) / (2 * kPi);
    wraps_.push_back(false);
    low.push_back(variables.contact_time_lower / time_unit_);
    high.push_back(variables.contact_time_upper / time_unit_);
  }
  lower = Eigen::Map<Eigen::VectorXd>(low.data(), static_cast<Eigen::Index>(low.size()));
  upper = Eigen::Map<Eigen::VectorXd>(high.data(), static_cast<Eigen::Index>(high.size()));
}

Eigen::VectorXd FreeVariables::sample(const Eigen::VectorXd& u) const {
  Eigen::VectorXd x = lower + u.cwiseProduct(upper - lower);
  if (vector_ < 0) return x;
  // Direction of an axis, evenly over a cap of the sphere, and the roll about it.
  const VariableSpec& variables = problem_.variables;
  const bool is_cone = variables.base_attitude == AttitudeFreedom::Cone;
  const double least = is_cone ? std::cos(variables.base_attitude_max) : -1;
  const Vector3d& axis = variables.base_attitude_axis;
  const double tilt = std::acos(1 - u[vector_] * (1 - least)), side = 2 * kPi * u[vector_ + 1];
  const Vector3d across = axis.unitOrthogonal();
  const Vector3d about = std::cos(side) * across + std::sin(side) * axis.cross(across);
  const Eigen::AngleAxisd rotation(Eigen::AngleAxisd(tilt, about) *
                                   Eigen::AngleAxisd(2 * kPi * u[vector_ + 2] - kPi, axis));
  x.segment<3>(vector_) = rotation.angle() * rotation.axis();
  return x;
}

bool FreeVariables::is_attitude_allowed(const Vector3d& rotation) const {
  const VariableSpec& variables = problem_.variables;
  if (variables.base_attitude != AttitudeFreedom::Cone) {
    return rotation.norm() <= variables.base_attitude_max;
  }
  const Vector3d& axis = variables.base_attitude_axis;
  const Eigen::AngleAxisd about(rotation.norm(), rotation.stableNormalized());
  return axis.dot(about * axis) >= std::cos(variables.base_attitude_max);
}

Configuration FreeVariables::at(const Eigen::VectorXd& x) const {
  Configuration out;
  out.phi = problem_.start;
  out.base = problem_.base;
  out.contact_time = problem_.variables.contact_time_lower;
  Eigen::Index i = 0;
  for (const int k : joints_) out.phi[k] = x[i++];
  if (has_angle_) {
    const Eigen::AngleAxisd rotation(x[i++], problem_.variables.base_attitude_axis);
    out.base.orientation = rotation * problem_.base.orientation;
  }
  if (vector_ >= 0) {
    const Vector3d rotation = x.segment<3>(vector_);
    out.base.orientation =
        Eigen::AngleAxisd(rotation.norm(), rotation.stableNormalized()) * problem_.base.orientation;
    i += 3;
  }
  if (has_time_) {
    // A Newton step may leave the bounds; the target's motion is known up to this far beyond them.
    constexpr double kBeyond = 0.5;  // s
    const VariableSpec& variables = problem_.variables;
    out.contact_time = std::clamp(x[i] * time_unit_, variables.contact_time_lower - kBeyond,
                                  variables.contact_time_upper + kBeyond);
  }
  return out;
}

Eigen::VectorXd FreeVariables::of(const Configuration& at) const {
  Eigen::VectorXd x(size());
  Eigen::Index i = 0;
  for (const int k : joints_) x[i++] = at.phi[k];
  if (has_angle_) x[i++] = base_angle(at);
  if (vector_ >= 0) {
    x.segment<3>(vector_) =
        rotation_log(at.base.orientation * problem_.base.orientation.conjugate());
    i += 3;
  }
  if (has_time_) x[i] = at.contact_time / time_unit_;
  return x;
}

double FreeVariables::base_angle(const Configuration& at) const {
  const Eigen::AngleAxisd rotation(at.base.orientation * problem_.base.orientation.conjugate());
  return rotation.angle() * rotation.axis().dot(problem_.variables.base_attitude_axis);
}

Eigen::VectorXd FreeVariables::middle_of(const JointBox& box) const {
  Eigen::VectorXd x = (lower + upper) / 2;
  Eigen::Index i = 0;
  for (const int k : joints_) x[i++] = (box.lower[k] + box.upper[k]) / 2;
  if (has_angle_ && box.base_angle) x[i] = (box.base_angle->lower + box.base_angle->upper) / 2;
  i += has_angle_;
  if (has_time_ && box.contact_time) {
    x[i] = (box.contact_time->lower + box.contact_time->upper) / 2 / time_unit_;
  }
  return x;
}

bool FreeVariables::holds(const JointBox& box, const Configuration& at) const {
  for (int k = 0; k < problem_.robot.n(); ++k) {
    double apart = at.phi[k] - (box.lower[k] + box.upper[k]) / 2;
    if (problem_.robot.joints[k].type == JointType::Continuous) {
      apart = wrapped(apart);
    }
    if (!(beyond(apart, box.lower[k], box.upper[k]) <= kNear)) return false;
  }
  if (has_angle_ != box.base_angle.has_value() || has_time_ != box.contact_time.has_value()) {
    return false;
  }
  if (has_angle_) {
    const Ends& ends = *box.base_angle;
    const double apart = wrapped(base_angle(at) - (ends.lower + ends.upper) / 2);
    if (!(beyond(apart, ends.lower, ends.upper) <= kNear)) return false;
  }
  if (has_time_) {
    const Ends& ends = *box.contact_time;
    const double apart = at.contact_time - (ends.lower + ends.upper) / 2;
    if (!(beyond(apart, ends.lower, ends.upper) <= kNearTime)) return false;
  }
  return true;
}

double FreeVariables::distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  double largest = 0;
  for (int i = 0; i < size(); ++i) {
    const double d = a[i] - b[i];
    largest = std::max(largest, std::abs(wraps_[i] ? wrapped(d) : d));
  }
  return largest;
}

bool FreeVariables::bring_inside(Eigen::VectorXd& x) const {
  bool is_inside = true;
  for (int i = 0; i < size(); ++i) {
    if (wraps_[i]) x[i] = wrapped(x[i]);
    if (vector_ >= 0 && i >= vector_ && i < vector_ + 3) continue;
    is_inside = is_inside && x[i] >= lower[i] && x[i] <= upper[i];
  }
  if (vector_ < 0) return is_inside;
  const Vector3d rotation = x.segment<3>(vector_);
  const double angle = rotation.norm();
  if (angle > kPi) x.segment<3>(vector_) = rotation * (wrapped(angle) / angle);
  return is_inside && is_attitude_allowed(x.segment<3>(vector_));
}

}  // namespace stillbase::audit
