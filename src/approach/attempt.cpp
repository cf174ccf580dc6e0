#include "approach/attempt.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <stillbase/core/constants.hpp>

#include <stillbase/encounter/target_motion.hpp>

#include "approach/base_motion.hpp"
#include "approach/closure.hpp"
#include "approach/effort.hpp"
#include "approach/polish.hpp"
#include "approach/reaction_null.hpp"
#include "approach/time_law.hpp"

namespace stillbase {

namespace {

/// The planner's space holds the free joints alone.
JointVectord full_posture(const ApproachTask& task, const JointVectord& part) {
  return with_free_part(task.goal.phi, task.free, part);
}

/// Joint limits; a full turn around start and goal where there are none.
void set_bounds(const ApproachTask& task, JointVectord& lower, JointVectord& upper) {
  const auto count = static_cast<Eigen::Index>(task.free.size());
  lower.resize(count);
  upper.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index k = task.free[static_cast<std::size_t>(i)];
    const Joint& joint = task.problem.robot.joints[static_cast<std::size_t>(k)];
    const double low = std::min(task.start[k], task.goal.phi[k]);
    const double high = std::max(task.start[k], task.goal.phi[k]);
    lower[i] = std::isfinite(joint.lower) ? std::min(joint.lower, low) : low - 2 * kPi;
    upper[i] = std::isfinite(joint.upper) ? std::max(joint.upper, high) : high + 2 * kPi;
  }
}

/// Limits hold on the segments, not only at the samples.
std::optional<std::string> broken_limit(const ApproachTask& task, const JointPath& path) {
  constexpr int kParts = 4;
  for (std::size_t i = 0; i < path.segments(); ++i) {
    for (int part = 0; part < kParts; ++part) {
      const double t = path.times[i] + (path.times[i + 1] - path.times[i]) * part / kParts;
      const JointVectord phi = motion_on_segment(path, i, t).phi;
      const Joint* joint = joint_outside_limits(task.problem.robot, phi, task.options.limit_slack);
      if (joint != nullptr) return joint->name;
    }
  }
  return std::nullopt;
}

std::vector<Pose> avoidable(const ApproachTask& task, const std::vector<Pose>& targets,
                            double resolution) {
  std::vector<Pose> kept;
  for (const Pose& target : targets) {
    const StillScene still(task.problem, task.scene, task.goal, {target}, resolution);
    if (!still.first_hit(task.start) && !still.first_hit(task.goal.phi)) kept.push_back(target);
  }
  return kept;
}

/// The target's motion to the hand at `end`.
std::optional<TargetMotion> target_for(const ApproachTask& task, const Configuration& end) {
  if (task.target == nullptr) return std::nullopt;
  const bool moves = end.base.position != task.goal.base.position || end.phi != task.goal.phi;
  if (!task.problem.impulse.direction || !moves) return *task.target;
  return encounter_motion(task.problem, end);
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

/// The scene of each goal.
std::vector<StillScene> scenes_of(const std::vector<AttemptGoal>& goals) {
  std::vector<StillScene> scenes;
  scenes.reserve(goals.size());
  for (const AttemptGoal& goal : goals) {
    const ApproachTask& task = *goal.task;
    scenes.emplace_back(task.problem, task.scene, task.goal,
                        avoidable(task, goal.options.targets, goal.options.resolution),
                        goal.options.resolution);
  }
  return scenes;
}

/// AttemptGoal points from a start to its goal by the planner of the task, or what went wrong.
std::vector<JointVectord> plan_points(const std::vector<AttemptGoal>& goals,
                                      const std::vector<StillScene>& scenes,
                                      const StopCondition& stop, AttemptResult& result,
                                      std::size_t& reached) {
  const ApproachTask& first = *goals.front().task;
  if (first.free.empty()) return {first.start, first.goal.phi};
  PathQuery query;
  query.resolution = goals.front().options.resolution;
  query.seed = goals.front().options.seed;
  query.max_iterations = 1;
  for (const AttemptGoal& goal : goals) {
    query.ends.push_back({free_part(goal.task->start, goal.task->free),
                          free_part(goal.task->goal.phi, goal.task->free), goal.weight});
    JointVectord lower, upper;
    set_bounds(*goal.task, lower, upper);
    const bool is_first = query.ends.size() == 1;
    query.lower = is_first ? lower : JointVectord(query.lower.cwiseMin(lower));
    query.upper = is_first ? upper : JointVectord(query.upper.cwiseMax(upper));
    query.max_iterations = std::max(query.max_iterations, goal.options.max_iterations);
  }
  query.stop = stop;
  query.options = first.options.path;
  query.is_valid = [&](std::size_t i, const JointVectord& part) {
    return !scenes[i].first_hit(full_posture(*goals[i].task, part));
  };
  query.is_motion_valid = [&](std::size_t i, const JointVectord& a, const JointVectord& b) {
    return scenes[i].is_motion_clear(full_posture(*goals[i].task, a),
                                     full_posture(*goals[i].task, b));
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
  const ApproachTask& task = *goals[reached].task;
  std::vector<JointVectord> points;
  for (const JointVectord& part : answer.points) points.push_back(full_posture(task, part));
  points.front() = task.start;
  points.back() = task.goal.phi;
  return points;
}

/// Whether nothing touches while the robot waits at a configuration.
bool can_wait(const ApproachTask& task, const Configuration& end, double wait) {
  const std::optional<TargetMotion> target = target_for(task, end);
  return !first_hit(task.problem, task.scene, waiting_motion(end, wait),
                    target ? &*target : nullptr);
}

/// The same within the reaction null space, as a motion from time 0.
JointPath plan_within_null_space(const std::vector<AttemptGoal>& goals,
                                 const std::vector<StillScene>& scenes, const StopCondition& stop,
                                 AttemptResult& result, std::size_t& reached) {
  const ApproachTask& first = *goals.front().task;
  NullPathQuery query;
  query.start = first.start;
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const ApproachTask& task = *goals[i].task;
    NullGoal goal;
    goal.posture = task.goal.phi;
    goal.scene = &scenes[i];
    goal.near = [&task](const JointVectord& phi, ContactSolve how) {
      return task.contact.near_posture ? task.contact.near_posture(phi, how)
                                       : std::optional<Configuration>(task.goal);
    };
    goal.measure = [&task](const Configuration& end) {
      return task.contact.measure ? task.contact.measure(end) : 0.0;
    };
    const double wait = goals[i].options.wait;
    goal.can_wait = [&task, wait](const Configuration& end) { return can_wait(task, end, wait); };
    query.goals.push_back(std::move(goal));
  }
  query.free = first.free;
  set_bounds(first, query.lower, query.upper);
  query.seed = goals.front().options.seed;
  query.max_iterations = goals.front().options.max_iterations;
  query.stop = stop;
  query.options = first.options.null_space;
  const NullPathAnswer answer = plan_null_path(query, first.problem);
  result.way_points = answer.curve.times.size();
  if (answer.curve.times.empty()) {
    result.status =
        answer.stopped ? ApproachStatus::TimeOut : ApproachStatus::UnreachableInBaseMode;
    result.detail = answer.detail;
    return {};
  }
  reached = answer.goal;
  result.end = answer.end;
  result.has_end = true;
  return time_curve(answer.curve, first.max_rate, first.problem.approach.acceleration_limit,
                    first.options.time_law);
}

/// The path with its time law, from time 0. Empty: see result.
JointPath plan_path(const std::vector<AttemptGoal>& goals, const StopCondition& stop,
                    AttemptResult& result, std::size_t& reached) {
  const std::vector<StillScene> scenes = scenes_of(goals);
  const ApproachTask& first = *goals.front().task;
  if (first.problem.approach.base == BaseMode::ReactionNull) {
    return plan_within_null_space(goals, scenes, stop, result, reached);
  }
  const std::vector<JointVectord> points = plan_points(goals, scenes, stop, result, reached);
  result.way_points = points.size();
  if (points.empty()) return {};
  const StillScene& scene = scenes[reached];
  return time_path(
      points, first.max_rate, first.problem.approach.acceleration_limit,
      [&](const JointVectord& a, const JointVectord& b) { return scene.is_motion_clear(a, b); },
      first.options.time_law);
}

}  // namespace

void finish_motion(const ApproachTask& task, JointPath path, double wait, AttemptResult& result) {
  const ApproachSpec& spec = task.problem.approach;
  result.status = ApproachStatus::GoalUnreachable;
  Configuration end = result.has_end ? result.end : task.goal;
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
    const double factor = stretch_for_limits(path, task.max_rate, spec.acceleration_limit);
    if (factor > 1) stretch(path, factor * (1 + 1e-9));
  } else {
    result.motion.base_poses = base_poses(task.problem.robot, path, spec.base, end.base);
  }
  slow_for_effort(task.problem, path, task.options.effort);
  result.end = end;
  result.has_end = true;

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
  if (const auto joint = broken_limit(task, result.motion.path)) {
    result.detail = "the path overshoots the limit of " + *joint;
    return;
  }
  const TargetMotion* target = result.target ? &*result.target : nullptr;
  if (const auto hit = first_hit(task.problem, task.scene, result.motion, target)) {
    result.hit_by_target = hit->proximity.first == kTargetName;
    result.hopeless = result.hit_by_target && spec.base == BaseMode::Held &&
                      is_on_base(task.problem, hit->proximity.second);
    result.status =
        result.hit_by_target ? ApproachStatus::HitEarly : ApproachStatus::GoalUnreachable;
    result.detail = fmt::format("{} at {:.3f} s, {:.3f} s before the contact (distance {:.4f} m)",
                                to_string(hit->proximity), hit->time, end.contact_time - hit->time,
                                hit->proximity.distance);
    return;
  }
  result.status = ApproachStatus::Found;
}

AttemptResult try_approach(const std::vector<AttemptGoal>& goals, const StopCondition& stop,
                           std::size_t& reached) {
  AttemptResult result;
  reached = 0;
  const JointPath path = plan_path(goals, stop, result, reached);
  if (path.times.empty()) return result;
  const AttemptGoal& goal = goals[reached];
  finish_motion(*goal.task, path, goal.options.wait, result);
  if (result.status == ApproachStatus::Found) polish(*goal.task, goal.options.wait, stop, result);
  return result;
}

}  // namespace stillbase
