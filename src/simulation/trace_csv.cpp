#include <fmt/format.h>

#include <stillbase/simulation/simulate.hpp>

namespace stillbase {
namespace {

/// A CSV field: quoted when the joint's name makes it necessary.
std::string quoted(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"') text += '"';
    text += c;
  }
  return text + '"';
}

class Header {
 public:
  void add(const std::string& name) {
    if (!text_.empty()) text_ += ',';
    text_ += quoted(name);
  }
  void add_vector(const std::string& name, const std::string& unit) {
    for (const char* axis : {"x", "y", "z"}) add(name + "_" + axis + "_" + unit);
  }
  /// One column per joint; prismatic joints have the second unit.
  void add_joints(const RobotModel& robot, const std::string& name, const std::string& revolute,
                  const std::string& prismatic) {
    for (const Joint& joint : robot.joints) {
      add(joint.name + "_" + name + "_" + (joint.is_prismatic() ? prismatic : revolute));
    }
  }
  std::string text() const { return text_ + "\n"; }

 private:
  std::string text_;
};

std::string header(const RobotModel& robot) {
  Header h;
  h.add("time_s");
  h.add_vector("base_position", "m");
  for (const char* part : {"w", "x", "y", "z"}) h.add(std::string("base_orientation_") + part);
  h.add_vector("base_velocity", "m_per_s");
  h.add_vector("base_rate", "rad_per_s");
  h.add_joints(robot, "position", "rad", "m");
  h.add_joints(robot, "rate", "rad_per_s", "m_per_s");
  h.add_joints(robot, "rate_rns", "rad_per_s", "m_per_s");
  h.add_joints(robot, "rate_orthogonal", "rad_per_s", "m_per_s");
  h.add_joints(robot, "torque", "Nm", "N");
  h.add_vector("angular_momentum_base", "Nms");
  h.add_vector("angular_momentum_coupling", "Nms");
  h.add_vector("angular_momentum_total", "Nms");
  h.add_vector("angular_momentum_total_inertial", "Nms");
  h.add_vector("linear_momentum_inertial", "Ns");
  h.add("kinetic_energy_J");
  h.add_vector("wheel_torque", "Nm");
  h.add_vector("wheel_momentum", "Nms");
  h.add_vector("thruster_torque", "Nm");
  h.add_vector("contact_force_inertial", "N");
  return h.text();
}

/// Shortest text that reads back to the same number; every field but the first has its comma.
template <class Numbers>
void append(std::string& text, const Numbers& numbers) {
  for (Eigen::Index i = 0; i < numbers.size(); ++i) {
    fmt::format_to(std::back_inserter(text), ",{}", numbers[i]);
  }
}

}  // namespace

std::string trace_csv(const RobotModel& robot, const std::vector<TraceSample>& trace) {
  std::string text = header(robot);
  for (const TraceSample& sample : trace) {
    const PlantState& state = sample.state;
    const Eigen::Quaterniond& q = state.base.orientation;
    text += fmt::format("{}", sample.time);
    append(text, state.base.position);
    append(text, Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
    append(text, state.Omega);
    append(text, state.phi);
    append(text, state.phidot);
    append(text, sample.rns);
    append(text, sample.orthogonal);
    append(text, sample.tau);
    append(text, sample.base);
    append(text, sample.coupling);
    append(text, sample.total);
    append(text, sample.total_N);
    append(text, sample.P_N);
    text += fmt::format(",{}", sample.kinetic_energy);
    append(text, sample.wheel_torque);
    append(text, state.wheel_momentum);
    append(text, sample.thruster_torque);
    append(text, sample.contact_force);
    text += '\n';
  }
  return text;
}

}  // namespace stillbase
