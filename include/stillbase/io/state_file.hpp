// State files: JSON with a posture, its velocities and an impulse, for `inspect`.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// A state of the robot seen from B.
struct RobotState {
  JointVectord phi;                   ///< n, rad or m
  JointVectord phidot;                ///< n, rad/s or m/s
  Vector6d Omega = Vector6d::Zero();  ///< base velocity [v; omega] in B, m/s, rad/s
  std::optional<Vector6d> Fbar;       ///< impulse [f; t] at the hand in B, N s, N m s
};

/// The state with all joints at zero and at rest.
RobotState zero_state(const RobotModel& robot);

/// Reads
///
///     {"joint_positions": [n], "joint_velocities": [n],
///      "base_velocity": {"linear": [3], "angular": [3]},
///      "impulse": {"force": [3], "moment": [3]}}
///
/// Missing parts are zero. Strict like a problem file, with the same units.
/// @param source name of the text for messages
/// @throws InputError with every finding
RobotState read_state(std::string_view text, const std::string& source, const RobotModel& robot);

/// The same without a robot: lists may have any length (one for both), maps any names, joints any
/// kind. Positions and rates come in the order of the text.
/// @throws InputError with every finding
RobotState read_state(std::string_view text, const std::string& source);

}  // namespace stillbase
