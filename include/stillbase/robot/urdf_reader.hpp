// URDF text to RobotModel, through urdfdom behind a guard of our own.
#pragma once

#include <string>
#include <string_view>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// Reads a robot.
///
/// Accepted: trees of revolute, continuous, prismatic and fixed joints. Fixed links are merged into
/// their parents (masses added, centroids averaged, parallel-axis theorem); then every body must
/// have mass > 0 and an inertia tensor that is positive definite and satisfies the triangle
/// inequality of principal moments.
/// @param text URDF; at most 1 MiB
/// @param source name of the file for messages
/// @param hand name of the hand link; when empty the only leaf link
/// @throws InputError with every finding: file, line, element and rule.
RobotModel read_urdf(std::string_view text, const std::string& source, const std::string& hand);

}  // namespace stillbase
