// What carries a shape beside the base and the bodies of the robot.
#pragma once

#include <stillbase/robot/robot_model.hpp>

namespace stillbase::verification {

/// Where a shape states the body that carries it. Below kBase, which is below all bodies.
inline constexpr int kInertial = kBase - 1, kOnTarget = kBase - 2;

}  // namespace stillbase::verification
