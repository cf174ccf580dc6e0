// Problem files: YAML with words for keys, as described in problems/README.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <stillbase/core/error.hpp>
#include <stillbase/plan/problem.hpp>
#include <stillbase/robot/unlocked_robot.hpp>

namespace stillbase {

/// Reads a problem file (`format: stillbase.problem`) with the robot and target files that it
/// names; their paths are relative to the problem file.
///
/// Strict: unknown, duplicate and missing keys, wrong types, lengths and units, numbers that are
/// not finite, names that do not exist and values that contradict each other are refused. A plain
/// number is SI; a text such as `-80 deg` is converted.
/// @param remarks set to what is allowed and looks like a mistake, where the problem is refused for
///   something else, too; may be null
/// @param unlocked set to the robot before its joints are locked where some are; may be null
/// @throws InputError with every finding: file, line, key, value, rule and what is allowed
/// @throws FileError when the system refuses to read a file that exists
CaptureProblem read_problem(const std::string& path, std::vector<Finding>* remarks = nullptr,
                            UnlockedRobot* unlocked = nullptr);

/// Line of a key of a problem file, 1-based: "robot.start". Of the nearest section that holds it
/// where the key is absent; 0 without one.
/// @throws InputError, FileError as read_problem()
int line_of_key(const std::string& path, const std::string& key);

/// Reads a problem from text, with the robot's text given: the inverse of problem_to_json(). No
/// file is opened, so the target must be stated in place.
/// @param source name of the text for messages
/// @throws InputError as read_problem()
CaptureProblem read_problem_text(std::string_view text, const std::string& source,
                                 const std::string& urdf);

/// The normalised copy as JSON: every field stated, in SI, numbers that read back exactly.
///
/// read_problem_text(problem_to_json(p), ..., p.urdf) equals p in every field but `source`.
/// @throws std::invalid_argument for a number that is not finite
std::string problem_to_json(const CaptureProblem& problem);

}  // namespace stillbase
