// State files.
#include <fmt/format.h>

#include "io/fields/plan.hpp"

namespace stillbase {

namespace io {

namespace {

/// Larger numbers of a state overflow in the products with each other and with the robot's.
constexpr double kLargest = 1e30;
constexpr Range kStateRange{.lower = -kLargest, .upper = kLargest};

/// One number per joint of a robot that is not known: any number of them, by name or in order.
struct AnyJoints : Value {
  AnyJoints(JointVectord& x, JointDimension dimension)
      : Value(JointValues(x, RobotModel{}, dimension, kAny, {.for_all = false})) {
    read = [&x, dimension](ReadContext& context, const Node& node, const std::string& path) {
      const std::size_t size = node.items.size(), before = context.findings.size();
      const bool is_list = node.kind == Node::Kind::Sequence || node.kind == Node::Kind::Map;
      if (!is_list || size == 0 || size > kMaxJoints) {
        context.add(
            node.line, is_list ? "wrong-length" : "wrong-type",
            fmt::format("{}: must be a list or a map of 1 to {} numbers", path, kMaxJoints));
        return false;
      }
      x.resize(static_cast<Eigen::Index>(size));
      for (std::size_t i = 0; i < size; ++i) {
        // Of a joint of unknown kind the number may be that of a revolute or of a prismatic one.
        const std::string item_path = fmt::format("{}[{}]", path, i);
        ReadContext trial{context.source, {}, {}};
        auto number =
            read_number(trial, node.items[i], item_path, dimension.prismatic, kStateRange);
        if (!number) {
          number = read_number(context, node.items[i], item_path, dimension.revolute, kStateRange);
        }
        x[static_cast<Eigen::Index>(i)] = number.value_or(0);
      }
      return context.findings.size() == before;
    };
  }
};

/// {upper: [3], lower: [3]} as one vector of 6; absent parts are zero.
Map two_vectors(Vector6d& both, const char* upper, Dimension upper_dimension, const char* lower,
                Dimension lower_dimension) {
  return Map([=, &both](Table& t) {
    Vector3d first = both.head<3>(), second = both.tail<3>();
    t(upper, Vector(first, upper_dimension), "", {.frame = "B"});
    t(lower, Vector(second, lower_dimension), "", {.frame = "B"});
    both << first, second;
    if (t.reader() == nullptr || both.cwiseAbs().maxCoeff() <= kLargest) return;
    t.reader()->context().add(t.reader()->line(), "out-of-range",
                              fmt::format("{}: every number must be in [{}, {}]",
                                          t.reader()->path(), -kLargest, kLargest));
  });
}

}  // namespace

void state_fields(Table& t, RobotState& state, const RobotModel* robot) {
  const auto joints = [&](const char* key, JointVectord& x, JointDimension dimension,
                          const char* text) {
    if (robot != nullptr) {
      t(key, JointValues(x, *robot, dimension, kStateRange, {.for_all = false}), text,
        {.without = "0"});
    } else {
      t(key, AnyJoints(x, dimension), text, {.without = "0"});
    }
  };
  joints("joint_positions", state.phi, kJointPosition, "posture");
  joints("joint_velocities", state.phidot, kJointVelocity, "joint rates");
  t("base_velocity",
    two_vectors(state.Omega, "linear", Dimension::Velocity, "angular", Dimension::AngularVelocity),
    "of the base", {.frame = "B", .without = "0"});
  Vector6d impulse = state.Fbar.value_or(Vector6d::Zero());
  t("impulse",
    two_vectors(impulse, "force", Dimension::Impulse, "moment", Dimension::AngularImpulse),
    "on the hand", {.frame = "B", .without = "none"});
  if (t.reader() == nullptr) return;
  if (t.reader()->has("impulse")) state.Fbar = impulse;
  if (state.phi.size() > 0 && state.phidot.size() > 0 && state.phi.size() != state.phidot.size()) {
    t.reader()->refuse("joint_velocities", "wrong-length",
                       fmt::format("has {} elements, joint_positions has {}", state.phidot.size(),
                                   state.phi.size()));
  }
}

}  // namespace io

RobotState zero_state(const RobotModel& robot) {
  RobotState state;
  state.phi = JointVectord::Zero(robot.n());
  state.phidot = JointVectord::Zero(robot.n());
  return state;
}

RobotState read_state(std::string_view text, const std::string& source, const RobotModel& robot) {
  RobotState state = zero_state(robot);
  io::read_map(text, source, [&](io::Table& t) { io::state_fields(t, state, &robot); });
  return state;
}

RobotState read_state(std::string_view text, const std::string& source) {
  RobotState state;
  io::read_map(text, source, [&](io::Table& t) { io::state_fields(t, state, nullptr); });
  return state;
}

}  // namespace stillbase
