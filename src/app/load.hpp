// Input files by what the user gave.
#pragma once

#include <string>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase::app {

/// Extension with its dot, lower case.
std::string extension_of(const std::string& path);

/// Reads a robot file.
/// @param hand name of the hand link; empty: the only leaf link
/// @throws CommandLineError when `hand` is empty and there are several leaf links
/// @throws InputError, FileError
RobotModel load_robot(const std::string& path, const std::string& hand);

}  // namespace stillbase::app
