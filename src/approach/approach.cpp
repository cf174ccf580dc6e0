#include <stillbase/approach/approach.hpp>

#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/random.hpp>

#include "approach/closure.hpp"
#include "approach/refusal.hpp"
#include "approach/replanning.hpp"
#include "approach/result.hpp"

namespace stillbase {

namespace {

Approach plan(ApproachTask& task, std::uint64_t seed, const StopCondition& stop,
              std::map<std::string, long>& solver_calls) {
  if (task.has_stated_start()) {
    // Where the base ends up is not known before there is a path; the straight line tells roughly.
    const ClosedPath straight = close_path(task.problem, straight_path(task), task.goal.base,
                                           task.contact, task.options.closure);
    if (straight.closed) task.goal = straight.end;
  }
  if (auto refused = refuse(task)) return *refused;
  Random seeds(seed);
  AttemptOptions options = first_options(task);
  AttemptResult failure;
  for (int attempt = 1; attempt <= task.options.attempts; ++attempt) {
    if (stop.reached()) return failed(ApproachStatus::TimeOut, "stopped before a path was found");
    options.seed = seeds.next();
    std::size_t only = 0;
    const AttemptResult result = try_approach({{&task, options, 1}}, stop, only);
    if (!task.free.empty()) ++solver_calls[planner_name(task.problem)];
    if (result.status == ApproachStatus::Found) {
      return finished(task, result, attempt, options.wait);
    }
    if (result.status == ApproachStatus::TimeOut || result.hopeless ||
        (attempt == 1 && result.way_points == 0)) {
      return failed(result.status, result.detail);
    }
    if (explains_more(result, failure)) failure = result;
    if (task.has_stated_start() && result.has_end) task.goal = result.end;
    adjust_options(task, result, attempt, options);
  }
  Approach none = failed(
      failure.status, fmt::format("{} (after {} attempts)", failure.detail, task.options.attempts));
  none.late_by = failure.shortfall;
  return none;
}

}  // namespace

Approach plan_approach(const CaptureProblem& problem, const Configuration& goal,
                       const TargetMotion* target, std::uint64_t seed, const StopCondition& stop,
                       std::map<std::string, long>& solver_calls, const ContactSolver& contact,
                       const ApproachOptions& options) {
  if (!problem.approach.enabled) {
    return failed(ApproachStatus::NotRequested, "no approach asked for");
  }
  ApproachTask task = make_task(problem, goal, target, contact, options);
  try {
    return plan(task, seed, stop, solver_calls);
  } catch (const std::out_of_range&) {  // from TargetMotion
    return failed(ApproachStatus::TooSlow,
                  "motion and wait reach back beyond the horizon of the target's prediction");
  }
}

}  // namespace stillbase
