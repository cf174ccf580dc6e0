#include "export/columns.hpp"

#include <fmt/format.h>

namespace stillbase {

namespace {

using Values = std::function<Eigen::VectorXd(const TrajectorySample&)>;

SampleColumns joint_columns(const RobotModel& robot, const std::string& name,
                            const std::string& revolute, const std::string& prismatic,
                            const Values& values) {
  SampleColumns columns{"joint_" + name, revolute + " (" + prismatic + ")", "", {}, {}, values};
  for (const Joint& joint : robot.joints) {
    columns.labels.push_back(joint.name + "_" + name);
    columns.units.push_back(joint.is_prismatic() ? prismatic : revolute);
  }
  return columns;
}

SampleColumns space_columns(const std::string& name, const std::string& unit,
                            const std::string& frame, const std::string& components,
                            const Values& values) {
  SampleColumns columns{name, unit, frame, {}, {}, values};
  for (const char component : components) {
    columns.labels.push_back(fmt::format("{}_{}_in_{}", name, component, frame));
    columns.units.push_back(unit);
  }
  return columns;
}

Eigen::VectorXd scalar_first(const Eigen::Quaterniond& q) {
  return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
}

}  // namespace

std::vector<SampleColumns> sample_columns(const Plan& plan) {
  using Sample = TrajectorySample;
  const RobotModel& robot = plan.problem.robot;
  std::vector<SampleColumns> columns{{"time", "s", "", {"time"}, {"s"}, [](const Sample& s) {
                                        return Eigen::VectorXd::Constant(1, s.time);
                                      }}};
  const auto joints = [&](const char* name, const char* revolute, const char* prismatic,
                          const Values& values) {
    columns.push_back(joint_columns(robot, name, revolute, prismatic, values));
  };
  const auto space = [&](const char* name, const char* unit, const char* frame,
                         const char* components, const Values& values) {
    columns.push_back(space_columns(name, unit, frame, components, values));
  };
  joints("position", "rad", "m", [](const Sample& s) { return s.phi; });
  joints("velocity", "rad/s", "m/s", [](const Sample& s) { return s.phidot; });
  joints("acceleration", "rad/s^2", "m/s^2", [](const Sample& s) { return s.phiddot; });
  joints("torque", "N m", "N", [](const Sample& s) { return s.tau; });
  space("base_position", "m", "N", "xyz", [](const Sample& s) { return s.base.position; });
  space("base_quaternion", "1", "N", "wxyz",
        [](const Sample& s) { return scalar_first(s.base.orientation); });
  space("base_linear_velocity", "m/s", "B", "xyz",
        [](const Sample& s) -> Eigen::VectorXd { return s.Omega.head<3>(); });
  space("base_angular_velocity", "rad/s", "B", "xyz",
        [](const Sample& s) -> Eigen::VectorXd { return s.Omega.tail<3>(); });
  if (!plan.problem.target) return columns;
  space("target_position", "m", "N", "xyz",
        [](const Sample& s) { return s.target->pose.position; });
  space("target_quaternion", "1", "N", "wxyz",
        [](const Sample& s) { return scalar_first(s.target->pose.orientation); });
  space("target_linear_velocity", "m/s", "N", "xyz",
        [](const Sample& s) { return s.target->linear_velocity; });
  space("target_angular_velocity", "rad/s", "N", "xyz",
        [](const Sample& s) { return s.target->angular_velocity; });
  return columns;
}

}  // namespace stillbase
