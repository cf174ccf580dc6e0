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

/// Whether both paths lead to one file, which need not exist; false when one is empty.
bool is_same_file(const std::string& a, const std::string& b);

}  // namespace stillbase::app
