// The approach to any of several goals: the first one that a feasible motion reaches.
#include <iterator>
#include <list>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/random.hpp>

#include "approach/refusal.hpp"
#include "approach/replanning.hpp"
#include "approach/result.hpp"

namespace stillbase {

namespace {

struct OpenGoal {
  std::size_t index = 0;  ///< among those asked for
  ApproachTask task;
  AttemptGoal attempt;
  int failures = 0;
};

/// The goals that are not refused before planning; `why` is the reason of the first refusal.
std::list<OpenGoal> open_goals(const CaptureProblem& problem,
                               const std::vector<ApproachGoal>& goals,
                               const ApproachOptions& options, Approach& why) {
  std::list<OpenGoal> open;
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const ApproachGoal& goal = goals[i];
    if (!(goal.weight > 0)) throw std::invalid_argument("approach: weights must be positive");
    ApproachTask task = make_task(problem, goal.configuration, goal.target, goal.contact, options);
    std::optional<Approach> refused;
    try {
      refused = refuse(task);
    } catch (const std::out_of_range&) {  // from TargetMotion
      refused = failed(ApproachStatus::TooSlow,
                       "the wait reaches back beyond the horizon of the target's prediction");
    }
    if (refused) {
      if (why.detail.empty()) why = *refused;
      continue;
    }
    const AttemptOptions first = first_options(task);
    open.push_back({i, std::move(task), {nullptr, first, goal.weight}, 0});
  }
  return open;
}

}  // namespace

ApproachToAny plan_approach_to_any(const CaptureProblem& problem,
                                   const std::vector<ApproachGoal>& goals, std::uint64_t seed,
                                   const StopCondition& stop,
                                   std::map<std::string, long>& solver_calls,
                                   const ApproachOptions& options) {
  if (goals.empty()) throw std::invalid_argument("approach: a set of goals needs one");
  if (!problem.approach.enabled) {
    return {failed(ApproachStatus::NotRequested, "no approach asked for"), 0};
  }
  ApproachToAny out;
  std::list<OpenGoal> open = open_goals(problem, goals, options, out.approach);
  if (!open.empty() && open.front().task.has_stated_start()) {
    throw std::invalid_argument(
        "approach: where a floating base starts as stated, every goal needs a path of its own");
  }
  if (open.empty()) return out;
  Random seeds(seed);
  AttemptResult failure;
  for (int attempt = 1; !open.empty(); ++attempt) {
    if (stop.reached()) {
      failure.status = ApproachStatus::TimeOut;
      failure.detail = "stopped before a path was found";
      break;
    }
    std::vector<AttemptGoal> tried;
    for (OpenGoal& goal : open) {
      goal.attempt.task = &goal.task;
      tried.push_back(goal.attempt);
    }
    tried.front().options.seed = seeds.next();
    std::size_t reached = 0;
    AttemptResult result;
    try {
      result = try_approach(tried, stop, reached);
    } catch (const std::out_of_range&) {  // from TargetMotion
      result.status = ApproachStatus::TooSlow;
      result.detail = "motion and wait reach back beyond the horizon of the target's prediction";
      result.way_points = 1;
      result.hopeless = true;
    }
    if (!open.front().task.free.empty()) ++solver_calls[planner_name(problem)];
    const auto at = std::next(open.begin(), static_cast<std::ptrdiff_t>(reached));
    OpenGoal& goal = *at;
    out.goal = goal.index;
    if (result.status == ApproachStatus::Found) {
      out.approach = finished(goal.task, result, attempt, goal.attempt.options.wait);
      if (goals.size() > 1) {
        out.approach.detail +=
            fmt::format("; goal {} of a set of {}", goal.index + 1, goals.size());
      }
      return out;
    }
    if (explains_more(result, failure)) failure = result;
    if (result.status == ApproachStatus::TimeOut || result.way_points == 0) break;
    adjust_options(goal.task, result, ++goal.failures, goal.attempt.options);
    if (goal.failures >= options.attempts_of_set || result.hopeless) {
      open.erase(at);
    }
  }
  out.approach = failed(
      failure.status, fmt::format("{} (going for {} goals at once)", failure.detail, goals.size()));
  out.approach.late_by = failure.shortfall;
  return out;
}

}  // namespace stillbase
