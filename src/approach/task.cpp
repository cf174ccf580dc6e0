#include "approach/task.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <stillbase/core/constants.hpp>
#include <stillbase/plan/turns.hpp>

#include "approach/time_law.hpp"

namespace stillbase {

namespace {

/// Numbers that the reader should have refused never get further than here.
void check_input(const CaptureProblem& problem, const Configuration& goal) {
  const ApproachSpec& spec = problem.approach;
  const int n = problem.robot.n();
  const auto demand = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("approach: ") + what);
  };
  demand(problem.start.size() == n && goal.phi.size() == n && spec.acceleration_limit.size() == n,
         "start, goal and acceleration limit need one number per joint");
  demand(problem.start.allFinite() && goal.phi.allFinite() && goal.base.is_finite() &&
             std::isfinite(goal.contact_time),
         "start and goal must be finite");
  demand(spec.acceleration_limit.allFinite() && (spec.acceleration_limit.array() > 0).all(),
         "acceleration limits must be finite and positive");
  for (const Joint& joint : problem.robot.joints) {
    demand(joint.max_velocity > 0, "joint rate limits must be positive");
  }
  demand(spec.velocity_scale > 0 && spec.velocity_scale <= 1, "velocity scale must be in (0, 1]");
  demand(std::isfinite(spec.wait) && spec.wait >= 0, "wait must be finite and not negative");
  demand(std::isfinite(spec.clearance) && spec.clearance >= 0, "clearance must not be negative");
  demand(std::isfinite(spec.resolution) && spec.resolution > 0, "resolution must be positive");
  demand(spec.max_duration > 0 && spec.max_iterations > 0, "limits must be positive");
  demand(problem.variables.joints.empty() || static_cast<int>(problem.variables.joints.size()) == n,
         "variables need one flag per joint");
  demand(static_cast<bool>(find_path_planner(spec.planner)), "unknown planner");
}

}  // namespace

ApproachTask make_task(const CaptureProblem& problem, const Configuration& goal,
                       const TargetMotion* target, const ContactSolver& contact,
                       const ApproachOptions& options) {
  check_input(problem, goal);
  ApproachTask task{problem,
                    goal,
                    target,
                    CollisionScene(problem),
                    find_path_planner(problem.approach.planner),
                    problem.start,
                    {JointVectord(problem.robot.n()), problem.approach.acceleration_limit},
                    {},
                    -kInfinity,
                    contact,
                    options};
  if (task.has_stated_start() && !contact.at_base) {
    throw std::invalid_argument(
        "approach: a floating base with a stated start needs ContactSolver::at_base");
  }
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    if (is_endless(problem.robot, k)) {
      task.start[k] += 2 * kPi * std::round((goal.phi[k] - task.start[k]) / (2 * kPi));
    }
    task.limits.rate[k] = joint.max_velocity * problem.approach.velocity_scale;
    const bool may_move = problem.variables.joints.empty() || problem.variables.joints[k];
    if (may_move || task.start[k] != goal.phi[k]) task.free.push_back(k);
  }
  // A predicted target is known from its estimate on, one with a stated direction at all times.
  if (target != nullptr && !problem.impulse.direction) {
    task.earliest_start = problem.target_state.time;
  }
  return task;
}

const Joint* joint_outside_limits(const RobotModel& robot, const JointVectord& phi, double slack) {
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[k];
    if (phi[k] < joint.lower - slack || phi[k] > joint.upper + slack) return &joint;
  }
  return nullptr;
}

void set_bounds(const ApproachTask& task, JointVectord& lower, JointVectord& upper) {
  const JointVectord low = task.start.cwiseMin(task.goal.phi);
  const JointVectord high = task.start.cwiseMax(task.goal.phi);
  lower = low(task.free).array() - 2 * kPi;
  upper = high(task.free).array() + 2 * kPi;
  for (std::size_t i = 0; i < task.free.size(); ++i) {
    const Joint& joint = task.problem.robot.joints[task.free[i]];
    if (std::isfinite(joint.lower)) lower[i] = std::min(joint.lower, low[task.free[i]]);
    if (std::isfinite(joint.upper)) upper[i] = std::max(joint.upper, high[task.free[i]]);
  }
}

JointPath straight_path(const ApproachTask& task) {
  return time_path(
      {task.start, task.goal.phi}, task.limits,
      [](const JointVectord&, const JointVectord&) { return true; }, task.options.time_law);
}

std::optional<Lateness> too_slow(const ApproachTask& task, double contact_time, double duration,
                                 double wait) {
  const double too_early = task.earliest_start - (contact_time - wait - duration);
  const double too_long = duration + wait - task.problem.approach.max_duration;
  const double seconds = std::max(too_early, too_long);
  if (seconds <= 0) return std::nullopt;
  return Lateness{seconds,
                  fmt::format("motion {:.3f} s and wait {:.3f} s before the contact at {:.3f} s: "
                              "{:.3f} s too slow {}",
                              duration, wait, contact_time, seconds,
                              too_early >= too_long ? "for a start after the target's estimate"
                                                    : "for the longest duration allowed")};
}

std::string planner_name(const CaptureProblem& problem) {
  return problem.approach.base == BaseMode::ReactionNull ? "reaction_null"
                                                         : problem.approach.planner;
}

}  // namespace stillbase
