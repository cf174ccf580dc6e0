#include "approach/attempt.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/encounter/target_motion.hpp>

#include "approach/base_motion.hpp"
#include "approach/closure.hpp"
#include "approach/effort.hpp"
#include "approach/polish.hpp"
#include "approach/reaction_null.hpp"
#include "approach/time_law.hpp"

namespace stillbase {

namespace {

/// The first joint that leaves its limits. They hold on the segments, not only at the samples.
const Joint* broken_limit(const ApproachTask& task, const JointPath& path) {
  const int parts = task.options.limit_checks;
  for (std::size_t i = 0; i < path.segments(); ++i) {
    for (int part = 0; part < parts; ++part) {
      const double t = path.times[i] + (path.times[i + 1] - path.times[i]) * part / parts;
      const Joint* joint = joint_outside_limits(
          task.problem.robot, motion_on_segment(path, i, t).phi, task.options.limit_slack);
      if (joint != nullptr) return joint;
    }
  }
  return nullptr;
}

/// The scene of a goal, without poses of the target that start or goal touch.
StillScene scene_of(const AttemptGoal& goal) {
  std::vector<Pose> kept;
  for (const Pose& target : goal.targets) {
    const StillScene still(goal.task, {target}, goal.resolution);
    if (!still.first_hit(goal.task.start) && !still.first_hit(goal.task.goal.phi)) {
      kept.push_back(target);
    }
  }
  return {goal.task, kept, goal.resolution};
}

/// Whether a link or obstacle is the base or fixed to it.
bool is_on_base(const CaptureProblem& problem, const std::string& name) {
  const LinkFrame* link = find_link(problem.robot, name);
  if (link != nullptr) return link->body == kBase;
  return std::any_of(problem.obstacles.begin(), problem.obstacles.end(),
                     [&](const Obstacle& obstacle) {
                       return obstacle.name == name && obstacle.frame == Frame::Base;
                     });
}

/// Whether the target at that time touches the robot where it waits for the contact.
bool hits_waiting_robot(const ApproachTask& task, double time) {
  const StillScene scene(task, {task.target->state(time).pose}, task.problem.approach.resolution);
  return scene.first_hit(task.goal.phi).has_value();
}

/// Waypoints from a start to its goal by the planner of the task, or what went wrong.
std::vector<JointVectord> plan_points(const std::vector<const AttemptGoal*>& goals,
                                      const std::vector<StillScene>& scenes, std::uint64_t seed,
                                      const StopCondition& stop, AttemptResult& result,
                                      std::size_t& reached) {
  const ApproachTask& first = goals.front()->task;
  if (first.free.empty()) return {first.start, first.goal.phi};
  PathQuery query;
  query.resolution = goals.front()->resolution;
  query.seed = seed;
  query.max_iterations = 1;
  for (const AttemptGoal* goal : goals) {
    const ApproachTask& task = goal->task;
    query.ends.push_back({task.start(task.free), task.goal.phi(task.free), goal->weight});
    JointVectord lower, upper;
    set_bounds(task, lower, upper);
    const bool is_first = query.ends.size() == 1;
    query.lower = is_first ? lower : JointVectord(query.lower.cwiseMin(lower));
    query.upper = is_first ? upper : JointVectord(query.upper.cwiseMax(upper));
    query.max_iterations = std::max(query.max_iterations, goal->max_iterations);
  }
  query.stop = stop;
  query.options = first.options.path;
  query.max_iterations = std::min(query.max_iterations, query.options.most_iterations);
  // The planner's space holds the free joints alone.
  const auto full = [&](std::size_t i, const JointVectord& part) {
    return with_free_part(goals[i]->task.goal.phi, goals[i]->task.free, part);
  };
  query.is_valid = [&](std::size_t i, const JointVectord& part) {
    return !scenes[i].first_hit(full(i, part));
  };
  query.is_motion_valid = [&](std::size_t i, const JointVectord& a, const JointVectord& b) {
    return scenes[i].is_motion_clear(full(i, a), full(i, b));
  };
  const PathAnswer answer = first.planner(query);
  if (answer.outcome == PathOutcome::Stopped) {
    result.status = ApproachStatus::TimeOut;
    result.detail = "stopped while the path was planned";
    return {};
  }
  if (answer.outcome == PathOutcome::NotFound) {
    result.detail = fmt::format("{} found no path in {} iterations", first.problem.approach.planner,
                                query.max_iterations);
    return {};
  }
  reached = answer.reached;
  std::vector<JointVectord> points;
  for (const JointVectord& part : answer.points) points.push_back(full(reached, part));
  points.front() = goals[reached]->task.start;
  points.back() = goals[reached]->task.goal.phi;
  return points;
}

/// The path with its time law, from time 0. Empty: see result.
JointPath plan_path(const std::vector<const AttemptGoal*>& goals, std::uint64_t seed,
                    const StopCondition& stop, AttemptResult& result, std::size_t& reached) {
  std::vector<StillScene> scenes;
  scenes.reserve(goals.size());
  for (const AttemptGoal* goal : goals) scenes.push_back(scene_of(*goal));
  const ApproachTask& first = goals.front()->task;
  PhaseClock* const clock = first.options.clock;
  const PhaseClock::Phase path(clock, "approach.path");
  const TimeLawOptions& options = first.options.time_law;
  if (first.problem.approach.base == BaseMode::ReactionNull) {
    const JointPath curve = plan_null_path(goals, scenes, seed, stop, result, reached);
    result.way_points = curve.times.size();
    const PhaseClock::Phase time_law(clock, "approach.time_law");
    return curve.times.empty() ? curve : time_curve(curve, first.limits, options);
  }
  const auto points = plan_points(goals, scenes, seed, stop, result, reached);
  result.way_points = points.size();
  if (points.empty()) return {};
  const PhaseClock::Phase time_law(clock, "approach.time_law");
  const auto is_clear = [&](const JointVectord& a, const JointVectord& b) {
    return scenes[reached].is_motion_clear(a, b);
  };
  return time_path(points, first.limits, is_clear, options);
}

}  // namespace

AttemptGoal::AttemptGoal(ApproachTask what)
    : task(std::move(what)),
      resolution(task.problem.approach.resolution),
      max_iterations(task.problem.approach.max_iterations),
      wait(task.problem.approach.wait) {
  avoid_target_at_arrival();
}

void AttemptGoal::avoid_target_at_arrival() {
  targets.clear();
  if (task.target != nullptr) {
    targets.push_back(task.target->state(task.goal.contact_time - wait).pose);
  }
}

std::optional<TargetMotion> target_for(const ApproachTask& task, const Configuration& end) {
  if (task.target == nullptr) return std::nullopt;
  const bool moves = end.base.position != task.goal.base.position || end.phi != task.goal.phi;
  if (!task.problem.impulse.direction || !moves) return *task.target;
  return encounter_motion(task.problem, end);
}

void finish_motion(const ApproachTask& task, JointPath path, double wait, AttemptResult& result) {
  const PhaseClock::Phase phase(task.options.clock, "approach.check");
  const ApproachSpec& spec = task.problem.approach;
  result.status = ApproachStatus::GoalUnreachable;
  Configuration end = result.end.value_or(task.goal);
  if (task.has_stated_start()) {
    ClosedPath closed =
        close_path(task.problem, path, task.goal.base, task.contact, task.options.closure);
    if (!closed.closed) {
      result.status = ApproachStatus::BaseDriftOpen;
      result.detail = std::isfinite(closed.open)
                          ? fmt::format(
                                "no posture near the end of the path reaches the target where the "
                                "path leaves the base: {:.3g} m or rad stay open",
                                closed.open)
                          : "where the path leaves the base no posture reaches the target";
      return;
    }
    path = std::move(closed.path);
    end = closed.end;
    result.motion.base_poses = std::move(closed.base_poses);
    keep_limits(path, task.limits);
  } else {
    result.motion.base_poses = base_poses(task.problem.robot, path, spec.base, end.base);
  }
  slow_for_effort(task.problem, path, task.options.effort);
  result.end = end;
  const double duration = path.times.back();
  result.motion.contact_time = end.contact_time;
  result.motion_end = end.contact_time - wait;
  result.motion_start = result.motion_end - duration;
  for (double& t : path.times) t += result.motion_start;
  path.times.back() = result.motion_end;
  result.motion.path = std::move(path);
  result.target = target_for(task, end);
  if (const auto lateness = too_slow(task, end.contact_time, duration, wait)) {
    result.status = ApproachStatus::TooSlow;
    result.shortfall = lateness->seconds;
    result.detail = lateness->text;
    return;
  }
  if (const Joint* joint = broken_limit(task, result.motion.path)) {
    result.detail = "the path overshoots the limit of " + joint->name;
    return;
  }
  if (const auto hit = first_hit(task, result.motion, result.target_or_null())) {
    result.hit_by_target = hit->proximity.first == kTargetName;
    const bool is_base = result.hit_by_target && is_on_base(task.problem, hit->proximity.second);
    result.hopeless = is_base && spec.base == BaseMode::Held;
    result.is_base_hit = is_base && !task.has_stated_start() && hits_waiting_robot(task, hit->time);
    result.status =
        result.hit_by_target ? ApproachStatus::HitEarly : ApproachStatus::GoalUnreachable;
    result.detail = fmt::format("{} at {:.3f} s, {:.3f} s before the contact (distance {:.4f} m)",
                                to_string(hit->proximity), hit->time, end.contact_time - hit->time,
                                hit->proximity.distance);
    return;
  }
  result.status = ApproachStatus::Found;
}

AttemptResult try_approach(const std::vector<const AttemptGoal*>& goals, std::uint64_t seed,
                           const StopCondition& stop, std::size_t& reached) {
  AttemptResult result;
  reached = 0;
  const JointPath path = plan_path(goals, seed, stop, result, reached);
  if (path.times.empty()) return result;
  const AttemptGoal& goal = *goals[reached];
  finish_motion(goal.task, path, goal.wait, result);
  if (result.status == ApproachStatus::Found) {
    const PhaseClock::Phase phase(goal.task.options.clock, "approach.polish");
    polish(goal.task, goal.wait, stop, result);
  }
  return result;
}

}  // namespace stillbase
