#include <stillbase/io/state_file.hpp>

#include <fmt/format.h>

#include "io/problem_reader.hpp"

namespace stillbase {

namespace {

/// Larger numbers of a state overflow in the products with each other and with the robot's.
constexpr double kLargest = 1e30;
constexpr io::Range kStateRange{.lower = -kLargest, .upper = kLargest};

/// {upper: [3], lower: [3]} as one vector of 6; absent parts are zero.
std::optional<Vector6d> read_pair(io::MapReader& map, const std::string& key, const char* upper,
                                  io::Dimension upper_dimension, const char* lower,
                                  io::Dimension lower_dimension) {
  const io::Node* node = map.child(key);
  if (node == nullptr) return std::nullopt;
  io::MapReader fields(map.context(), *node, map.path_of(key));
  Vector3d first = Vector3d::Zero(), second = Vector3d::Zero();
  fields.vector3(upper, first, upper_dimension);
  fields.vector3(lower, second, lower_dimension);
  fields.finish();
  Vector6d both;
  both << first, second;
  if (!(both.cwiseAbs().maxCoeff() <= kLargest)) {
    map.context().add(
        node->line, "out-of-range",
        fmt::format("{}: every number must be in [{}, {}]", map.path_of(key), -kLargest, kLargest));
  }
  return both;
}

/// A number of a joint of unknown kind, that of a revolute or of a prismatic one.
double read_joint_number(io::ReadContext& context, const io::Node& node, const std::string& path,
                         io::Dimension revolute, io::Dimension prismatic) {
  io::ReadContext trial{context.source, {}, {}};
  if (const auto x = io::read_number(trial, node, path, prismatic, kStateRange)) return *x;
  return io::read_number(context, node, path, revolute, kStateRange).value_or(0);
}

void read_joints_of_any(io::MapReader& map, const std::string& key, io::Dimension revolute,
                        io::Dimension prismatic, JointVectord& out) {
  const io::Node* node = map.child(key);
  if (node == nullptr) return;
  io::ReadContext& context = map.context();
  const std::size_t size = node->items.size();
  const bool is_list = node->kind == io::Node::Kind::Sequence || node->kind == io::Node::Kind::Map;
  if (!is_list || size == 0 || size > kMaxJoints) {
    context.add(node->line, is_list ? "wrong-length" : "wrong-type",
                fmt::format("{}: must be a list or a map of 1 to {} numbers", map.path_of(key),
                            kMaxJoints));
    return;
  }
  out.resize(static_cast<Eigen::Index>(size));
  for (std::size_t i = 0; i < size; ++i) {
    out[static_cast<Eigen::Index>(i)] = read_joint_number(
        context, node->items[i], fmt::format("{}[{}]", map.path_of(key), i), revolute, prismatic);
  }
}

/// What does not depend on the robot.
void read_base_and_impulse(io::MapReader& map, RobotState& state) {
  using io::Dimension;
  const auto velocity = read_pair(map, "base_velocity", "linear", Dimension::Velocity, "angular",
                                  Dimension::AngularVelocity);
  if (velocity) state.Omega = *velocity;
  state.Fbar =
      read_pair(map, "impulse", "force", Dimension::Impulse, "moment", Dimension::AngularImpulse);
  map.finish();
  map.context().throw_if_any();
}

}  // namespace

RobotState zero_state(const RobotModel& robot) {
  RobotState state;
  state.phi = JointVectord::Zero(robot.n());
  state.phidot = JointVectord::Zero(robot.n());
  return state;
}

RobotState read_state(std::string_view text, const std::string& source, const RobotModel& robot) {
  using io::Dimension;
  io::ReadContext context{source, {}, {}};
  const io::Node root = io::parse_document(text, context);
  io::MapReader map(context, root, "");
  RobotState state = zero_state(robot);
  io::read_joint_values(map, "joint_positions", robot, Dimension::Angle, Dimension::Length,
                        kStateRange, false, io::Need::Optional, state.phi);
  io::read_joint_values(map, "joint_velocities", robot, Dimension::AngularVelocity,
                        Dimension::Velocity, kStateRange, false, io::Need::Optional, state.phidot);
  read_base_and_impulse(map, state);
  return state;
}

RobotState read_state(std::string_view text, const std::string& source) {
  using io::Dimension;
  io::ReadContext context{source, {}, {}};
  const io::Node root = io::parse_document(text, context);
  io::MapReader map(context, root, "");
  RobotState state;
  read_joints_of_any(map, "joint_positions", Dimension::Angle, Dimension::Length, state.phi);
  read_joints_of_any(map, "joint_velocities", Dimension::AngularVelocity, Dimension::Velocity,
                     state.phidot);
  if (state.phi.size() > 0 && state.phidot.size() > 0 && state.phi.size() != state.phidot.size()) {
    context.add(map.line_of("joint_velocities"), "wrong-length",
                fmt::format("joint_velocities: has {} elements, joint_positions has {}",
                            state.phidot.size(), state.phi.size()));
  }
  read_base_and_impulse(map, state);
  return state;
}

}  // namespace stillbase
