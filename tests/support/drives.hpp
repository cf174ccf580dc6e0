// Robots with drives.
#pragma once

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// The same robot with a drive on every third joint.
inline RobotModel with_drives(RobotModel robot) {
  for (std::size_t k = 0; k < robot.joints.size(); k += 3) {
    robot.joints[k].rotor_inertia = 1e-3;
    robot.joints[k].gear_ratio = 40;
  }
  return robot;
}

}  // namespace stillbase
