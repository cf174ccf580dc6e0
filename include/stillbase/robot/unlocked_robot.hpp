// A robot before a problem locks joints of it.
#pragma once

#include <map>
#include <string>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// It shows what the links do that a lock merges.
struct UnlockedRobot {
  RobotModel robot;                      ///< masses are not checked, the hand is any link
  std::map<std::string, double> locked;  ///< positions of its locked joints, by full name, rad or m
};

}  // namespace stillbase
