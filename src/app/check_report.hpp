// What `check` understood of a file, in words; remarks on what is suspicious at the end.
#pragma once

#include <string>
#include <vector>

#include <stillbase/core/error.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/state_file.hpp>
#include <stillbase/plan/problem.hpp>

namespace stillbase::app {

std::string robot_report(const RobotModel& robot);
std::string target_report(const TargetBody& target);
/// @param remarks of the reader
std::string problem_report(const CaptureProblem& problem, const std::vector<Finding>& remarks = {});
std::string plan_report(const PlanFile& file);
std::string state_report(const RobotState& state, const RobotModel& robot);
/// Of a state that no robot was named for.
std::string lone_state_report(const RobotState& state);

/// What random postures say of links that touch always or never, as lines of a problem file.
std::string contact_suggestions(const RobotModel& robot);

/// "suspicious:" and one line each, or nothing when there are none.
std::string remark_lines(const std::vector<std::string>& remarks);

/// Reads a problem. Arms that are mounted on one base do not stand in each other, nor locked links
/// in what they are merged with, and the start posture keeps the clearance that the approach asks
/// for. Where the file is refused, its remarks are said first: they often name the mistake.
/// @param remarks set to those of the reader
/// @throws InputError, FileError as read_problem()
CaptureProblem read_placed_problem(const std::string& path, std::vector<Finding>& remarks);

}  // namespace stillbase::app
