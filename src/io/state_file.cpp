#include <stillbase/io/state_file.hpp>

#include "io/fields/plan.hpp"
#include "io/read_map.hpp"

namespace stillbase {

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
