// Benchmark logs in OMPL's own format, which ompl_benchmark_statistics.py turns into a database for
// Planner Arena.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stillbase {

/// ompl::base::PlannerStatus::StatusType, same numbers.
enum class PlannerLogStatus {
  Unknown,
  InvalidStart,
  InvalidGoal,
  UnrecognizedGoalType,
  Timeout,
  ApproximateSolution,
  ExactSolution,
  Crash,
  Abort
};

struct PlannerLogRun {
  PlannerLogStatus status = PlannerLogStatus::Unknown;
  bool solved = false;
  std::optional<int> outcome;     ///< index into PlannerLog::outcomes
  std::optional<double> seconds;  ///< path, time law and all checks
  std::optional<long> planner_calls;
  std::optional<double> length;    ///< of the path in joint space, rad
  std::optional<double> duration;  ///< of the motion, s
  std::optional<long> samples;
};

struct PlannerLogPlanner {
  std::string name;
  std::vector<PlannerLogRun> runs;
};

struct PlannerLog {
  std::string experiment;     ///< one word
  std::string setup;          ///< free text
  std::string host, started;  ///< where and when, in words
  std::uint64_t seed = 1;
  double seconds_limit = 0;
  int runs_per_planner = 0;
  std::vector<std::string> outcomes;  ///< words of our own status
  std::vector<PlannerLogPlanner> planners;
};

/// The log's text; what a run does not have is an empty field.
std::string planner_log_to_text(const PlannerLog& log);

}  // namespace stillbase
