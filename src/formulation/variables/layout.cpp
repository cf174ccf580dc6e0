#include "formulation/variables/layout.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>

namespace stillbase {

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
  }
  // What a cone leaves to the turn as a whole: everything.
  const bool is_cone = problem.variables.base_attitude == AttitudeFreedom::Cone;
  const double turn = is_cone ? kPi : problem.variables.base_attitude_max;
  if (problem.variables.base_attitude != AttitudeFreedom::Fixed) {
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
  lower = Eigen::Map<Eigen::VectorXd>(low.data(), size);
  upper = Eigen::Map<Eigen::VectorXd>(high.data(), size);
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

Eigen::Matrix3Xd VariableLayout::attitude_rates(const CaptureProblem& problem,
                                                const Eigen::VectorXd& x) const {
  if (attitude_size == 1) {
    return attitude_of(problem, x).conjugate() * problem.variables.base_attitude_axis;
  }
  if (attitude_size == 3) return rotation_right_jacobian(x.segment<3>(attitude));
  return Eigen::Matrix3Xd(3, 0);
}

double VariableLayout::contact_time(const CaptureProblem& problem, const Eigen::VectorXd& x) const {
  return time < 0 ? problem.variables.contact_time_lower : x[time];
}

}  // namespace stillbase
