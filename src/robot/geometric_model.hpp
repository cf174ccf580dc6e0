// A robot whose masses do not matter.
#pragma once

#include <string_view>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// read_urdf() without checks of masses and inertias, with any hand: for its joints and shapes.
/// @throws InputError as read_urdf()
RobotModel read_geometric_model(std::string_view text);

}  // namespace stillbase
