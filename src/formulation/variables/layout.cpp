#include "formulation/variables/layout.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/plan/turns.hpp>

namespace stillbase {

namespace {

/// Largest attitude variable. Without a limit of the attitude the bounds are beyond the numbers of
/// the shortest rotations, so that no such rotation is at them. Rotation vectors whose entries are
/// less than 3.6 rad stay shorter than 2 pi, where they would be singular.
double largest_attitude(const VariableSpec& variables) {
  const double limit = variables.base_attitude_max;
  // A cone bounds no component of the rotation vector.
  if (variables.base_attitude != AttitudeFreedom::Cone && limit < kEveryAttitude) return limit;
  return variables.base_attitude == AttitudeFreedom::Axis ? 2 * kPi : 3.6;
}

}  // namespace

VariableLayout::VariableLayout(const CaptureProblem& problem) {
  const RobotModel& robot = problem.robot;
  std::vector<double> low, high;
  for (int k = 0; k < robot.n(); ++k) {
    if (!problem.variables.joints[k]) continue;
    joints.push_back(k);
    const Joint& joint = robot.joints[k];
    const double margin =
        joint.type == JointType::Continuous ? 0 : problem.constraints.joint_limit_margin;
    low.push_back(joint.lower + margin);
    high.push_back(joint.upper - margin);
    angles_.push_back(has_whole_turns(problem, k) ? Angle::WholeTurns
                      : is_endless(robot, k)      ? Angle::Continuous
                                                  : Angle::Limited);
  }
  if (problem.variables.base_attitude != AttitudeFreedom::Fixed) {
    const double turn = largest_attitude(problem.variables);
    attitude = static_cast<int>(low.size());
    attitude_size = problem.variables.base_attitude == AttitudeFreedom::Axis ? 1 : 3;
    low.insert(low.end(), attitude_size, -turn);
    high.insert(high.end(), attitude_size, turn);
  }
  if (problem.variables.contact_time_upper > problem.variables.contact_time_lower) {
    time = static_cast<int>(low.size());
    low.push_back(problem.variables.contact_time_lower);
    high.push_back(problem.variables.contact_time_upper);
  }
  size = static_cast<int>(low.size());
  lower = lower_limit = Eigen::Map<Eigen::VectorXd>(low.data(), size);
  upper = upper_limit = Eigen::Map<Eigen::VectorXd>(high.data(), size);
  for (std::size_t i = 0; i < angles_.size(); ++i) {
    if (angles_[i] != Angle::WholeTurns) continue;
    lower[static_cast<int>(i)] = -kInfinity;
    upper[static_cast<int>(i)] = kInfinity;
  }
}

JointVectord VariableLayout::joint_positions(const CaptureProblem& problem,
                                             const Eigen::VectorXd& x) const {
  JointVectord phi = problem.start;
  for (std::size_t i = 0; i < joints.size(); ++i) phi[joints[i]] = x[static_cast<int>(i)];
  return phi;
}

Eigen::Quaterniond VariableLayout::attitude_of(const CaptureProblem& problem,
                                               const Eigen::VectorXd& x) const {
  const Eigen::Quaterniond& stated = problem.base.orientation;
  if (attitude_size == 1) {
    return (rotation_exp(problem.variables.base_attitude_axis * x[attitude]) * stated).normalized();
  }
  if (attitude_size == 3) {
    return (stated * rotation_exp(x.segment<3>(attitude))).normalized();
  }
  return stated;
}

double VariableLayout::contact_time(const CaptureProblem& problem, const Eigen::VectorXd& x) const {
  return time < 0 ? problem.variables.contact_time_lower : x[time];
}

Eigen::VectorXd VariableLayout::variables(const CaptureProblem& problem,
                                          const Configuration& configuration) const {
  Eigen::VectorXd x(size);
  const Eigen::Quaterniond& stated = problem.base.orientation;
  const Eigen::Quaterniond& here = configuration.base.orientation;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    x[static_cast<int>(i)] = configuration.phi[joints[i]];
  }
  if (time >= 0) x[time] = configuration.contact_time;
  if (attitude_size == 3) {
    x.segment<3>(attitude) = rotation_log(stated.conjugate() * here);
  } else if (attitude_size == 1) {
    x[attitude] = rotation_log(here * stated.conjugate()).dot(problem.variables.base_attitude_axis);
  }
  return x;
}

Eigen::VectorXd VariableLayout::start_point(const CaptureProblem& problem,
                                            const Eigen::VectorXd& u) const {
  Eigen::VectorXd x(size);
  for (int i = 0; i < size; ++i) {
    double low = lower[i], high = upper[i];
    if (i == attitude && attitude_size == 1) {
      high = problem.variables.base_attitude_max;
      low = -high;
    }
    if (!std::isfinite(low) || !std::isfinite(high)) {
      low = std::isfinite(low) ? low : (std::isfinite(high) ? high - 2 * kPi : -kPi);
      high = std::isfinite(high) ? high : low + 2 * kPi;
    }
    x[i] = low + u[i] * (high - low);
  }
  if (attitude_size == 3) {
    const double limit = problem.variables.base_attitude_max;
    const double a = u[attitude], b = u[attitude + 1], c = u[attitude + 2];
    if (problem.variables.base_attitude == AttitudeFreedom::Cone) {
      // The axis uniform over its cap, the roll uniform over 2 pi.
      const Vector3d& axis = problem.variables.base_attitude_axis;
      const auto [e_1, e_2] = tangent_basis(axis);
      const double tilt = std::acos(1 - a * (1 - std::cos(limit)));
      const Vector3d about = std::cos(2 * kPi * b) * e_1 + std::sin(2 * kPi * b) * e_2;
      const Eigen::Quaterniond turn =
          rotation_exp(tilt * about) * rotation_exp(kPi * (2 * c - 1) * axis);
      const Eigen::Quaterniond& stated = problem.base.orientation;
      x.segment<3>(attitude) = rotation_log(stated.conjugate() * turn * stated);
    } else if (limit > kEveryAttitude) {
      // Uniform over rotations (Shoemake, Graphics Gems III, 1992).
      const Eigen::Quaterniond q(
          std::sqrt(a) * std::cos(2 * kPi * c), std::sqrt(1 - a) * std::sin(2 * kPi * b),
          std::sqrt(1 - a) * std::cos(2 * kPi * b), std::sqrt(a) * std::sin(2 * kPi * c));
      x.segment<3>(attitude) = rotation_log(q);
    } else {
      const double z = 2 * a - 1, r = std::sqrt(std::max(0.0, 1 - z * z));
      x.segment<3>(attitude) =
          limit * std::cbrt(c) * Vector3d(r * std::cos(2 * kPi * b), r * std::sin(2 * kPi * b), z);
    }
  }
  return x;
}

double VariableLayout::distance(const CaptureProblem& problem, const Eigen::VectorXd& a,
                                const Eigen::VectorXd& b) const {
  const Eigen::VectorXd apart = difference(a, b);
  double sum = 0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const double d = apart[static_cast<int>(i)];
    sum += d * d;
  }
  if (attitude_size > 0) {
    const double angle = attitude_of(problem, a).angularDistance(attitude_of(problem, b));
    sum += angle * angle;
  }
  if (time >= 0) sum += std::pow(a[time] - b[time], 2);
  return std::sqrt(sum);
}

bool VariableLayout::are_within(const CaptureProblem& problem, const Eigen::VectorXd& a,
                                const Eigen::VectorXd& b, double most) const {
  // Most are told apart by their joints.
  constexpr double kRounding = 1e-9;
  const double far = most * most * (1 + kRounding);
  double sum = 0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double d = a[k] - b[k];
    const double apart = angles_[i] != Angle::Limited ? wrap_angle(d) : d;
    sum += apart * apart;
    if (sum > far) return false;
  }
  return distance(problem, a, b) <= most;
}

Eigen::VectorXd VariableLayout::difference(const Eigen::VectorXd& a,
                                           const Eigen::VectorXd& b) const {
  Eigen::VectorXd out = a - b;
  for (std::size_t i = 0; i < angles_.size(); ++i) {
    double& apart = out[static_cast<int>(i)];
    if (angles_[i] != Angle::Limited) apart = wrap_angle(apart);
  }
  return out;
}

Eigen::VectorXd VariableLayout::normalised(const CaptureProblem& problem, Eigen::VectorXd x) const {
  for (std::size_t i = 0; i < angles_.size(); ++i) {
    double& angle = x[static_cast<int>(i)];
    const Joint& joint = problem.robot.joints[static_cast<std::size_t>(joints[i])];
    if (angles_[i] == Angle::Continuous) angle = wrap_angle(angle);
    if (angles_[i] == Angle::WholeTurns) angle = central_angle(joint, angle);
  }
  return x;
}

Eigen::VectorXd VariableLayout::within_limits(const CaptureProblem& problem,
                                              Eigen::VectorXd x) const {
  for (std::size_t i = 0; i < angles_.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    if (angles_[i] != Angle::WholeTurns) continue;
    if (x[j] >= lower_limit[j] && x[j] <= upper_limit[j]) continue;
    x[j] = central_angle(problem.robot.joints[static_cast<std::size_t>(joints[i])], x[j]);
  }
  return x;
}

}  // namespace stillbase
