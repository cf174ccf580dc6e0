#include "verification/free_variables.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>

namespace stillbase::verification {
namespace {

// Candidates meet their constraints to 1e-9; another solution is never this near.
constexpr double kNear = 1e-6;      // rad, m
constexpr double kNearTime = 1e-5;  // s: targets are slow

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
    const Joint& joint = problem.robot.joints[static_cast<std::size_t>(k)];
    if (!variables.joints[static_cast<std::size_t>(k)]) continue;
    const bool turns = joint.type == JointType::Continuous;
    joints_.push_back(k);
    turns_.push_back(turns);
    low.push_back(turns ? -kPi : joint.lower + margin);
    high.push_back(turns ? kPi : joint.upper - margin);
  }
  has_angle_ = variables.base_attitude == AttitudeFreedom::Axis;
  if (has_angle_) {
    const double most = std::min(variables.base_attitude_max, kPi);
    turns_.push_back(most == kPi);
    low.push_back(-most);
    high.push_back(most);
  }
  if (variables.base_attitude == AttitudeFreedom::Cone ||
      variables.base_attitude == AttitudeFreedom::Free) {
    turn_ = static_cast<int>(low.size());
    turns_.insert(turns_.end(), 3, false);
    low.insert(low.end(), 3, -kPi);
    high.insert(high.end(), 3, kPi);
  }
  has_time_ = variables.contact_time_upper > variables.contact_time_lower;
  if (has_time_) {
    time_unit_ = (variables.contact_time_upper - variables.contact_time_lower) / (2 * kPi);
    turns_.push_back(false);
    low.push_back(variables.contact_time_lower / time_unit_);
    high.push_back(variables.contact_time_upper / time_unit_);
  }
  lower = Eigen::Map<Eigen::VectorXd>(low.data(), static_cast<Eigen::Index>(low.size()));
  upper = Eigen::Map<Eigen::VectorXd>(high.data(), static_cast<Eigen::Index>(high.size()));
}

Eigen::VectorXd FreeVariables::sample(const Eigen::VectorXd& u) const {
  Eigen::VectorXd x = lower + u.cwiseProduct(upper - lower);
  if (turn_ < 0) return x;
  // Which way an axis points, evenly over a cap of the sphere, and the roll about it.
  const VariableSpec& variables = problem_.variables;
  const bool is_cone = variables.base_attitude == AttitudeFreedom::Cone;
  const double least = is_cone ? std::cos(variables.base_attitude_max) : -1;
  const Vector3d& axis = variables.base_attitude_axis;
  const double tilt = std::acos(1 - u[turn_] * (1 - least)), side = 2 * kPi * u[turn_ + 1];
  const Vector3d across = axis.unitOrthogonal();
  const Vector3d about = std::cos(side) * across + std::sin(side) * axis.cross(across);
  const Eigen::AngleAxisd turn(Eigen::AngleAxisd(tilt, about) *
                               Eigen::AngleAxisd(2 * kPi * u[turn_ + 2] - kPi, axis));
  x.segment<3>(turn_) = turn.angle() * turn.axis();
  return x;
}

bool FreeVariables::is_attitude_allowed(const Vector3d& turn) const {
  const VariableSpec& variables = problem_.variables;
  if (variables.base_attitude != AttitudeFreedom::Cone) {
    return turn.norm() <= variables.base_attitude_max;
  }
  const Vector3d& axis = variables.base_attitude_axis;
  const Eigen::AngleAxisd about(turn.norm(), turn.stableNormalized());
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
    const Eigen::AngleAxisd turn(x[i++], problem_.variables.base_attitude_axis);
    out.base.orientation = turn * problem_.base.orientation;
  }
  if (turn_ >= 0) {
    const Vector3d turn = x.segment<3>(turn_);
    out.base.orientation =
        Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()) * problem_.base.orientation;
    i += 3;
  }
  if (has_time_) {
    // A step of Newton's may go anywhere, the target's motion is known a little beyond the bounds.
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
  if (turn_ >= 0) {
    x.segment<3>(turn_) = rotation_log(at.base.orientation * problem_.base.orientation.conjugate());
    i += 3;
  }
  if (has_time_) x[i] = at.contact_time / time_unit_;
  return x;
}

double FreeVariables::base_angle(const Configuration& at) const {
  const Eigen::AngleAxisd turn(at.base.orientation * problem_.base.orientation.conjugate());
  return turn.angle() * turn.axis().dot(problem_.variables.base_attitude_axis);
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
    if (problem_.robot.joints[static_cast<std::size_t>(k)].type == JointType::Continuous) {
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
    largest = std::max(largest, std::abs(turns_[static_cast<std::size_t>(i)] ? wrapped(d) : d));
  }
  return largest;
}

bool FreeVariables::bring_inside(Eigen::VectorXd& x) const {
  bool is_inside = true;
  for (int i = 0; i < size(); ++i) {
    if (turns_[static_cast<std::size_t>(i)]) x[i] = wrapped(x[i]);
    if (turn_ >= 0 && i >= turn_ && i < turn_ + 3) continue;
    is_inside = is_inside && x[i] >= lower[i] && x[i] <= upper[i];
  }
  if (turn_ < 0) return is_inside;
  const Vector3d turn = x.segment<3>(turn_);
  const double angle = turn.norm();
  if (angle > kPi) x.segment<3>(turn_) = turn * (wrapped(angle) / angle);
  return is_inside && is_attitude_allowed(x.segment<3>(turn_));
}

}  // namespace stillbase::verification
