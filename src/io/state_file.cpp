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
  const auto velocity = read_pair(map, "base_velocity", "linear", Dimension::Velocity, "angular",
                                  Dimension::AngularVelocity);
  if (velocity) state.Omega = *velocity;
  state.Fbar =
      read_pair(map, "impulse", "force", Dimension::Impulse, "moment", Dimension::AngularImpulse);
  map.finish();
  context.throw_if_any();
  return state;
}

}  // namespace stillbase
