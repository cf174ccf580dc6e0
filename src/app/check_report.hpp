// What `check` understood of a file, in words; remarks on what is suspicious at the end.
#pragma once

#include <string>
#include <vector>

#include <stillbase/core/error.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/state_file.hpp>
#include <stillbase/plan/problem.hpp>
#include <stillbase/robot/unlocked_robot.hpp>

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

/// Arms that are mounted on one base do not stand in each other, nor locked links in what they are
/// merged with, and the start posture keeps the clearance that the approach asks for.
/// @param unlocked from the same file
/// @param path of the problem file
/// @throws InputError
void check_placement(const CaptureProblem& problem, const UnlockedRobot& unlocked,
                     const std::string& path);

}  // namespace stillbase::app
