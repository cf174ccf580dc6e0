#include <stillbase/approach/approach.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/random.hpp>

#include "approach/arrival.hpp"
#include "approach/attempt.hpp"
#include "approach/base_motion.hpp"
#include "approach/closure.hpp"
#include "approach/effort.hpp"

namespace stillbase {

namespace {

/// An approach that was not found, and why.
Approach failed(ApproachStatus status, const std::string& detail, double late_by = 0) {
  Approach approach;
  approach.status = status;
  approach.detail = detail;
  approach.late_by = late_by;
  return approach;
}

constexpr const char* kBeyondHorizon =
    "motion and wait reach back beyond the horizon of the target's prediction";

/// Checks of start, goal, wait and the duration of the straight line. Nothing: planning may begin.
std::optional<Approach> refuse(const ApproachTask& task) {
  using enum ApproachStatus;
  const PhaseClock::Phase phase(task.options.clock, "approach.check");
  const CaptureProblem& problem = task.problem;
  const ApproachSpec& spec = problem.approach;
  const auto clearance_text = [&](const Proximity& hit) {
    return fmt::format("{}: distance {:.4f} m, clearance {:.4f} m asked for", to_string(hit),
                       std::max(hit.distance, 0.0), spec.clearance);
  };
  const std::pair<ApproachStatus, const JointVectord*> ends[] = {{StartInvalid, &task.start},
                                                                 {GoalInvalid, &task.goal.phi}};
  for (const auto& [status, phi] : ends) {
    const Joint* joint = joint_outside_limits(problem.robot, *phi, task.options.limit_slack);
    if (joint == nullptr) continue;
    return failed(status, fmt::format("{} at {:.6g} is outside its limits [{:.6g}, {:.6g}]",
                                      joint->name, (*phi)[joint - problem.robot.joints.data()],
                                      joint->lower, joint->upper));
  }
  const StillScene alone(task, {}, spec.resolution);
  for (const auto& [status, phi] : ends) {
    if (const auto hit = alone.first_hit(*phi)) return failed(status, clearance_text(*hit));
  }
  JointPath straight = straight_path(task);
  const auto lateness = [&](double duration) {
    return too_slow(task, task.goal.contact_time, duration, spec.wait);
  };
  // Torques are looked at where they could make it too slow: of the path that is found they are in
  // any case.
  constexpr double kSlowed = 4;  // torques 16 times as large as usable
  if (lateness(kSlowed * straight.times.back())) {
    slow_for_effort(problem, straight, task.options.effort);
  }
  if (const auto late = lateness(straight.times.back()))
    return failed(TooSlow, late->text, late->seconds);
  if (task.target == nullptr) return std::nullopt;
  const Pose at_contact = task.target->state(task.goal.contact_time).pose;
  if (const auto hit = StillScene(task, {at_contact}, spec.resolution).first_hit(task.goal.phi)) {
    return failed(GoalInvalid, "at the contact " + clearance_text(*hit));
  }
  if (const auto hit = first_hit(task, waiting_motion(task.goal, spec.wait), task.target)) {
    return failed(HitEarly, fmt::format("while the robot waits: {} at {:.3f} s, {:.3f} s before "
                                        "the contact",
                                        to_string(hit->proximity), hit->time,
                                        task.goal.contact_time - hit->time));
  }
  return std::nullopt;
}

/// Whether a failure explains more than the known one: a collision more than a delay, then the
/// least delay.
bool explains_more(const AttemptResult& result, const AttemptResult& known) {
  if (known.detail.empty() || result.status == ApproachStatus::TimeOut) return true;
  if (result.status == ApproachStatus::TooSlow) {
    return known.status == ApproachStatus::TooSlow && result.shortfall < known.shortfall;
  }
  return result.way_points > 0;
}

/// Changes how a goal is attempted after one more attempt that failed with `result`.
void adjust(AttemptGoal& goal, const AttemptResult& result) {
  const ApproachSpec& spec = goal.task.problem.approach;
  const ApproachOptions& options = goal.task.options;
  if (goal.task.has_stated_start() && result.end) goal.task.goal = *result.end;
  ++goal.failures;
  goal.max_iterations = spec.max_iterations;
  if (goal.failures + 1 == options.attempts) {
    // Last resort: the target is no obstacle for the planner, the check over time decides alone.
    goal.wait = spec.wait;
    goal.targets.clear();
  } else if (result.hit_by_target) {
    // The target's poses during the motion. More cautious than needed and often without a solution:
    // not worth the full effort.
    const double duration = result.motion_end - result.motion_start;
    const int count = options.swept_poses;
    goal.targets.clear();
    for (int i = 0; i < count; ++i) {
      const double t = result.motion_end - duration * i / (count - 1);
      goal.targets.push_back(result.target->state(t).pose);
    }
    goal.max_iterations = std::max(1, goal.max_iterations / options.swept_effort);
    if (goal.failures % options.longer_wait_every == 0) goal.wait += duration / 2;
  } else if (result.way_points == 0) {
    goal.avoid_target_at_arrival();
  } else if (result.status == ApproachStatus::TooSlow) {
    goal.wait = spec.wait;
  } else {
    goal.resolution /= 2;
  }
}

/// A found motion as the plan states it. @param tries attempts that it took
Approach finished(const AttemptGoal& goal, const AttemptResult& found, int tries) {
  const ApproachTask& task = goal.task;
  const PhaseClock::Phase phase(task.options.clock, "approach.check");
  const RobotModel& robot = task.problem.robot;
  const TimedMotion& motion = found.motion;
  const JointPath& path = motion.path;
  const Pose& end = motion.base_poses.back();
  Approach approach;
  approach.status = ApproachStatus::Found;
  const auto add = [&](double time, const Pose& base, const JointMotion& at,
                       const JointVectord& torques, const Vector6d& Omega) {
    approach.times.push_back(time);
    approach.base_poses.push_back(base);
    approach.joint_positions.push_back(at.phi);
    approach.joint_velocities.push_back(at.phidot);
    approach.joint_accelerations.push_back(at.phiddot);
    approach.joint_torques.push_back(torques);
    approach.base_velocities.push_back(Omega);
  };
  const JointVectord zero = JointVectord::Zero(robot.n());
  const JointMotion still{path.phi.back(), zero, zero};
  for (std::size_t i = 0; i < path.times.size(); ++i) {
    JointMotion at{path.phi[i], path.phidot[i], zero};
    if (i < path.segments()) at.phiddot = motion_on_segment(path, i, path.times[i]).phiddot;
    const Pose& base = motion.base_poses[i];
    add(path.times[i], base, at, i < path.segments() ? joint_torques(task.problem, at) : zero,
        task.problem.approach.base == BaseMode::Held ? Vector6d(Vector6d::Zero())
                                                     : base_velocity(robot, at));
    approach.attitude_excursion =
        std::max(approach.attitude_excursion,
                 rotation_log(end.orientation.conjugate() * base.orientation).norm());
  }
  if (motion.contact_time > path.times.back()) {
    add(motion.contact_time, end, still, zero, Vector6d::Zero());
  }
  const auto hand_at = [&](const JointVectord& phi, const Pose& base) {
    const auto kinematics = compute_kinematics<double>(robot, phi);
    return base * Pose{kinematics.r_bh, Eigen::Quaterniond(kinematics.R_hand)};
  };
  const Pose hand = hand_at(path.phi.back(), end);
  const Pose wanted = hand_at(found.end->phi, found.end->base);
  approach.hand_position_error = (hand.position - wanted.position).norm();
  approach.hand_angle_error =
      rotation_log(wanted.orientation.conjugate() * hand.orientation).norm();
  approach.effort_used = effort_used(task.problem, path, task.options.effort);
  approach.polish = task.problem.approach.polish;
  approach.before_polish = found.before_polish;
  approach.after_polish = found.after_polish;
  approach.duration = path.times.back() - path.times.front();
  approach.path_length = length(path, task.options.length_parts);
  const Proximity closest = smallest_clearance(task, motion, found.target_or_null());
  approach.min_clearance = closest.distance;
  approach.detail =
      fmt::format("{} way points by {} in {} {}; moves for {:.3f} s, waits for {:.3f} s; {}",
                  found.way_points, planner_name(task.problem), tries,
                  tries == 1 ? "attempt" : "attempts", approach.duration, goal.wait,
                  std::isfinite(closest.distance)
                      ? fmt::format("closest: {}, {:.4f} m", to_string(closest), closest.distance)
                      : "no pair of bodies that could collide");
  return approach;
}

/// Adds a goal unless it is refused before planning; then the reason.
std::optional<Approach> admit(ApproachTask task, double weight, std::size_t index,
                              std::vector<AttemptGoal>& goals) {
  try {
    if (task.has_stated_start()) {
      // The final base pose is not known before there is a path: the straight line estimates it.
      const ClosedPath straight = close_path(task.problem, straight_path(task), task.goal.base,
                                             task.contact, task.options.closure);
      if (straight.closed) task.goal = straight.end;
    }
    if (auto refused = refuse(task)) return refused;
    AttemptGoal goal(std::move(task));
    goal.weight = weight;
    goal.index = index;
    goals.push_back(std::move(goal));
    return std::nullopt;
  } catch (const std::out_of_range&) {  // from TargetMotion
    return failed(ApproachStatus::TooSlow, kBeyondHorizon);
  }
}

/// Attempts until a motion is found or every goal was left out.
/// @param limit infeasible motions after which a goal is left out
/// @param asked number of goals asked for together, 0 for a goal of its own
ApproachToAny attempt_all(std::vector<AttemptGoal>& goals, int limit, std::size_t asked,
                          std::uint64_t seed, const StopCondition& stop,
                          std::map<std::string, long>& solver_calls) {
  ApproachToAny out;
  Random seeds(seed);
  AttemptResult failure;
  int attempts = 0;
  for (;;) {
    std::vector<const AttemptGoal*> open;
    for (const AttemptGoal& goal : goals) {
      if (goal.failures < limit) open.push_back(&goal);
    }
    if (open.empty()) break;
    if (stop.reached()) {
      failure.status = ApproachStatus::TimeOut;
      failure.detail = "before a path was found";
      break;
    }
    ++attempts;
    std::size_t reached = 0;
    AttemptResult result;
    const auto goal_reached = [&]() -> AttemptGoal& { return goals[open[reached] - goals.data()]; };
    try {
      result = try_approach(open, seeds.next(), stop, reached);
      if (result.status == ApproachStatus::Found) {
        out.approach = finished(*open[reached], result, attempts);
      } else {
        adjust(goal_reached(), result);
      }
    } catch (const std::out_of_range&) {  // from TargetMotion
      result = {};
      result.status = ApproachStatus::TooSlow;
      result.detail = kBeyondHorizon;
      result.way_points = 1;
      result.hopeless = true;
    }
    AttemptGoal& goal = goal_reached();
    if (!goal.task.free.empty()) ++solver_calls[planner_name(goal.task.problem)];
    out.goal = goal.index;
    if (result.status == ApproachStatus::Found) {
      if (asked > 1) {
        out.approach.detail += fmt::format("; goal {} of a set of {}", out.goal + 1, asked);
      }
      return out;
    }
    if (explains_more(result, failure)) failure = result;
    const bool no_path = result.way_points == 0 && (asked > 0 || attempts == 1);
    if (result.status == ApproachStatus::TimeOut || no_path) break;
    const ApproachOptions& options = goal.task.options;
    const int most_base_hits = asked > 0 ? options.base_hits_of_set : options.base_hits;
    if (result.is_base_hit && ++goal.base_hits >= most_base_hits) result.hopeless = true;
    if (result.hopeless) goal.failures = limit;
  }
  if (asked > 0) {
    out.base_hits.resize(asked);
    for (const AttemptGoal& goal : goals) out.base_hits[goal.index] = goal.base_hits;
    if (asked > 1) failure.detail += fmt::format(" (going for {} goals at once)", asked);
  } else if (attempts > 1) {
    failure.detail += fmt::format(" (after {} attempts)", attempts);
  }
  out.approach = failed(failure.status, failure.detail, failure.shortfall);
  if (asked == 0) out.approach.base_hits = goals.front().base_hits;
  return out;
}

/// A goal of a hand that moves: the run to it, and where that begins.
struct MovingGoal {
  ApproachTask task;  ///< to the contact
  Arrival arrival;
};

/// The problem of the approach to where a run begins.
CaptureProblem problem_at_rest(const CaptureProblem& problem, double longest_run) {
  CaptureProblem out = problem;
  out.approach.max_duration = std::max(out.approach.max_duration - longest_run, 1e-3);
  return out;
}

double run_time(const Arrival& arrival) {
  return arrival.run.path.times.back() - arrival.run.path.times.front();
}

/// @return the goal, or why there is none
std::optional<Approach> admit_moving(const CaptureProblem& problem, const Configuration& goal,
                                     const TargetMotion* target, const ContactSolver& contact,
                                     const ApproachOptions& options,
                                     std::vector<MovingGoal>& goals) {
  try {
    ApproachTask task = make_task(problem, goal, target, contact, options);
    Arrival arrival = plan_arrival(task, options.arrival);
    if (!arrival.failure.empty()) return failed(ApproachStatus::GoalInvalid, arrival.failure);
    goals.push_back({std::move(task), std::move(arrival)});
    return std::nullopt;
  } catch (const std::out_of_range&) {  // from TargetMotion
    return failed(ApproachStatus::TooSlow, kBeyondHorizon);
  }
}

/// plan_approach() for a hand that moves at the contact.
Approach approach_with_run(const CaptureProblem& problem, const Configuration& goal,
                           const TargetMotion* target, std::uint64_t seed,
                           const StopCondition& stop, std::map<std::string, long>& solver_calls,
                           const ContactSolver& contact, const ApproachOptions& options) {
  std::vector<MovingGoal> moving;
  if (auto refused = admit_moving(problem, goal, target, contact, options, moving)) return *refused;
  const Arrival& arrival = moving.front().arrival;
  const CaptureProblem still = problem_at_rest(problem, run_time(arrival));
  std::vector<AttemptGoal> goals;
  if (auto refused = admit(make_task(still, arrival.rest, target, contact, options), 1, 0, goals)) {
    return *refused;
  }
  Approach out = attempt_all(goals, options.attempts, 0, seed, stop, solver_calls).approach;
  if (out.status == ApproachStatus::Found) append_arrival(moving.front().task, arrival, out);
  return out;
}

/// plan_approach_to_any() for a hand that moves at the contact.
ApproachToAny approach_with_run_to_any(const CaptureProblem& problem,
                                       const std::vector<ApproachGoal>& goals, std::uint64_t seed,
                                       const StopCondition& stop,
                                       std::map<std::string, long>& solver_calls,
                                       const ApproachOptions& options) {
  ApproachToAny out;
  std::vector<MovingGoal> moving;
  std::vector<std::size_t> asked;  // index of each
  double longest = 0;
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const ApproachGoal& goal = goals[i];
    const auto refused =
        admit_moving(problem, goal.configuration, goal.target, goal.contact, options, moving);
    if (refused) {
      if (out.approach.detail.empty()) out.approach = *refused;
      continue;
    }
    asked.push_back(i);
    longest = std::max(longest, run_time(moving.back().arrival));
  }
  const CaptureProblem still = problem_at_rest(problem, longest);
  std::vector<AttemptGoal> open;
  for (std::size_t j = 0; j < moving.size(); ++j) {
    const ApproachGoal& goal = goals[asked[j]];
    const auto refused =
        admit(make_task(still, moving[j].arrival.rest, goal.target, goal.contact, options),
              goal.weight, j, open);
    if (refused && out.approach.detail.empty()) out.approach = *refused;
  }
  if (open.empty()) return out;
  out = attempt_all(open, options.attempts_of_set, goals.size(), seed, stop, solver_calls);
  if (!out.base_hits.empty()) {
    std::vector<int> base_hits(goals.size());
    for (std::size_t j = 0; j < asked.size(); ++j) base_hits[asked[j]] = out.base_hits[j];
    out.base_hits = std::move(base_hits);
  }
  const MovingGoal& reached = moving[out.goal];
  if (out.approach.status == ApproachStatus::Found) {
    append_arrival(reached.task, reached.arrival, out.approach);
  }
  out.goal = asked[out.goal];
  return out;
}

}  // namespace

Approach plan_approach(const CaptureProblem& problem, const Configuration& goal,
                       const TargetMotion* target, std::uint64_t seed, const StopCondition& stop,
                       std::map<std::string, long>& solver_calls, const ContactSolver& contact,
                       const ApproachOptions& options) {
  if (!problem.approach.enabled) {
    return failed(ApproachStatus::NotRequested, "no approach asked for");
  }
  if (problem.hand_motion.moves()) {
    return approach_with_run(problem, goal, target, seed, stop, solver_calls, contact, options);
  }
  std::vector<AttemptGoal> goals;
  if (auto refused = admit(make_task(problem, goal, target, contact, options), 1, 0, goals)) {
    return *refused;
  }
  return attempt_all(goals, options.attempts, 0, seed, stop, solver_calls).approach;
}

ApproachToAny plan_approach_to_any(const CaptureProblem& problem,
                                   const std::vector<ApproachGoal>& goals, std::uint64_t seed,
                                   const StopCondition& stop,
                                   std::map<std::string, long>& solver_calls,
                                   const ApproachOptions& options) {
  if (goals.empty()) throw std::invalid_argument("approach: a set of goals needs one");
  if (!problem.approach.enabled) {
    return {failed(ApproachStatus::NotRequested, "no approach asked for"), 0};
  }
  if (problem.hand_motion.moves()) {
    return approach_with_run_to_any(problem, goals, seed, stop, solver_calls, options);
  }
  ApproachToAny out;
  std::vector<AttemptGoal> open;
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const ApproachGoal& goal = goals[i];
    if (!(goal.weight > 0)) throw std::invalid_argument("approach: weights must be positive");
    ApproachTask task = make_task(problem, goal.configuration, goal.target, goal.contact, options);
    if (task.has_stated_start()) {
      throw std::invalid_argument(
          "approach: where a floating base starts as stated, every goal needs a path of its own");
    }
    const auto refused = admit(std::move(task), goal.weight, i, open);
    if (refused && out.approach.detail.empty()) out.approach = *refused;
  }
  if (open.empty()) return out;
  return attempt_all(open, options.attempts_of_set, goals.size(), seed, stop, solver_calls);
}

}  // namespace stillbase
