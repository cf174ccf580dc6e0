#include <fmt/format.h>

#include <stillbase/simulation/simulate.hpp>

#include "core/escape.hpp"

namespace stillbase {
namespace {

using Sample = const TraceSample&;
using Values = Eigen::VectorXd;

enum class Per { Run, Quaternion, Axis, Joint };

/// Columns of one quantity.
struct Quantity {
  Per per;
  const char *name, *unit;
  Values (*values)(Sample);
  const char* prismatic_unit = "";
};

const Quantity kQuantities[] = {
    {Per::Run, "time", "s", [](Sample s) -> Values { return Values::Constant(1, s.time); }},
    {Per::Axis, "base_position", "m", [](Sample s) -> Values { return s.state.base.position; }},
    {Per::Quaternion, "base_orientation", "",
     [](Sample s) -> Values {
       const Eigen::Quaterniond& q = s.state.base.orientation;
       return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
     }},
    {Per::Axis, "base_velocity", "m_per_s",
     [](Sample s) -> Values { return s.state.Omega.head<3>(); }},
    {Per::Axis, "base_rate", "rad_per_s",
     [](Sample s) -> Values { return s.state.Omega.tail<3>(); }},
    {Per::Joint, "position", "rad", [](Sample s) -> Values { return s.state.phi; }, "m"},
    {Per::Joint, "rate", "rad_per_s", [](Sample s) -> Values { return s.state.phidot; }, "m_per_s"},
    {Per::Joint, "rate_rns", "rad_per_s", [](Sample s) -> Values { return s.rns; }, "m_per_s"},
    {Per::Joint, "rate_orthogonal", "rad_per_s", [](Sample s) -> Values { return s.orthogonal; },
     "m_per_s"},
    {Per::Joint, "torque", "Nm", [](Sample s) -> Values { return s.tau; }, "N"},
    {Per::Joint, "torque_demanded", "Nm", [](Sample s) -> Values { return s.demanded_tau; }, "N"},
    {Per::Axis, "angular_momentum_base", "Nms", [](Sample s) -> Values { return s.base; }},
    {Per::Axis, "angular_momentum_coupling", "Nms", [](Sample s) -> Values { return s.coupling; }},
    {Per::Axis, "angular_momentum_total", "Nms", [](Sample s) -> Values { return s.total; }},
    {Per::Axis, "angular_momentum_total_inertial", "Nms",
     [](Sample s) -> Values { return s.total_N; }},
    {Per::Axis, "linear_momentum_inertial", "Ns", [](Sample s) -> Values { return s.P_N; }},
    {Per::Run, "kinetic_energy", "J",
     [](Sample s) -> Values { return Values::Constant(1, s.kinetic_energy); }},
    {Per::Axis, "wheel_torque", "Nm", [](Sample s) -> Values { return s.wheel_torque; }},
    {Per::Axis, "wheel_momentum", "Nms", [](Sample s) -> Values { return s.state.wheel_momentum; }},
    {Per::Axis, "thruster_torque", "Nm", [](Sample s) -> Values { return s.thruster_torque; }},
    {Per::Axis, "contact_force_inertial", "N", [](Sample s) -> Values { return s.contact_force; }},
    {Per::Axis, "grip_force", "N", [](Sample s) -> Values { return s.grip_wrench.head<3>(); }},
    {Per::Axis, "grip_moment", "Nm", [](Sample s) -> Values { return s.grip_wrench.tail<3>(); }},
};

std::vector<std::string> column_names(const Quantity& quantity, const RobotModel& robot) {
  const std::string name = quantity.name, unit = std::string("_") + quantity.unit;
  switch (quantity.per) {
    case Per::Run:
      return {name + unit};
    case Per::Quaternion:
      return {name + "_w", name + "_x", name + "_y", name + "_z"};
    case Per::Axis:
      return {name + "_x" + unit, name + "_y" + unit, name + "_z" + unit};
    case Per::Joint:
      break;
  }
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints) {
    names.push_back(fmt::format("{}_{}_{}", joint.name, name,
                                joint.is_prismatic() ? quantity.prismatic_unit : quantity.unit));
  }
  return names;
}

}  // namespace

std::string trace_csv(const RobotModel& robot, const std::vector<TraceSample>& trace) {
  std::string text;
  for (const Quantity& quantity : kQuantities) {
    for (const std::string& name : column_names(quantity, robot)) text += csv_field(name) + ',';
  }
  text.back() = '\n';
  for (const TraceSample& sample : trace) {
    // Shortest text that reads back to the same number.
    for (const Quantity& quantity : kQuantities) {
      for (const double x : quantity.values(sample))
        fmt::format_to(std::back_inserter(text), "{},", x);
    }
    text.back() = '\n';
  }
  return text;
}

}  // namespace stillbase
