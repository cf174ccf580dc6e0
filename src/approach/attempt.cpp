#include "approach/attempt.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/plan/encounter.hpp>

#include "approach/base_motion.hpp"
#include "approach/closure.hpp"
#include "approach/effort.hpp"
#include "approach/polish.hpp"
#include "approach/reaction_null.hpp"
#include "approach/time_law.hpp"

namespace stillbase {

namespace {

/// A posture may lie this far outside a joint limit: what optimizers leave behind.
constexpr double kLimitSlack = 1e-6;
constexpr double kTurn = 6.283185307179586;

/// The planner's space holds the free joints alone.
JointVectord free_part(const ApproachTask& task, const JointVectord& phi) {
  JointVectord part(static_cast<Eigen::Index>(task.free.size()));
  for (std::size_t i = 0; i < task.free.size(); ++i) {
    part[static_cast<Eigen::Index>(i)] = phi[task.free[i]];
  }
  return part;
}

JointVectord full_posture(const ApproachTask& task, const JointVectord& part) {
  JointVectord phi = task.goal.phi;
  for (std::size_t i = 0; i < task.free.size(); ++i) {
    phi[task.free[i]] = part[static_cast<Eigen::Index>(i)];
  }
  return phi;
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
    lower[i] = std::isfinite(joint.lower) ? std::min(joint.lower, low) : low - kTurn;
    upper[i] = std::isfinite(joint.upper) ? std::max(joint.upper, high) : high + kTurn;
  }
}

/// Limits hold on the segments, not only at the samples.
std::optional<std::string> broken_limit(const ApproachTask& task, const JointPath& path) {
  constexpr int kParts = 4;
  for (std::size_t i = 0; i < path.segments(); ++i) {
    for (int part = 0; part < kParts; ++part) {
      const double t = path.times[i] + (path.times[i + 1] - path.times[i]) * part / kParts;
      const JointVectord phi = motion_on_segment(path, i, t).phi;
      for (int k = 0; k < task.problem.robot.n(); ++k) {
        const Joint& joint = task.problem.robot.joints[static_cast<std::size_t>(k)];
        if (phi[k] < joint.lower - kLimitSlack || phi[k] > joint.upper + kLimitSlack) {
          return joint.name;
        }
      }
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

/// The target on its way to where the hand is at `end`.
std::optional<TargetMotion> target_for(const ApproachTask& task, const Configuration& end) {
  if (task.target == nullptr) return std::nullopt;
  const bool moves = end.base.position != task.goal.base.position || end.phi != task.goal.phi;
  if (!task.problem.impulse.direction || !moves) return *task.target;
  const auto kinematics = compute_kinematics<double>(task.problem.robot, end.phi);
  return encounter_motion(task.problem, end.base * Vector3d(kinematics.r_bh), end.base.orientation,
                          end.contact_time);
}

/// Whether a thing of the scene is the base or fixed to it.
bool is_on_base(const CaptureProblem& problem, const std::string& name) {
  const LinkFrame* link = find_link(problem.robot, name);
  if (link != nullptr) return link->body == kBase;
  return std::any_of(problem.obstacles.begin(), problem.obstacles.end(),
                     [&](const Obstacle& obstacle) {
                       return obstacle.name == name && obstacle.frame == Frame::Base;
                     });
}

/// Way points from start to goal by the planner of the task, or what went wrong.
std::vector<JointVectord> plan_points(const ApproachTask& task, const AttemptOptions& options,
                                      const StillScene& still, const StopCondition& stop,
                                      AttemptResult& result) {
  if (task.free.empty()) return {task.start, task.goal.phi};
  PathQuery query;
  query.start = free_part(task, task.start);
  query.goal = free_part(task, task.goal.phi);
  set_bounds(task, query.lower, query.upper);
  query.resolution = options.resolution;
  query.seed = options.seed;
  query.max_iterations = options.max_iterations;
  query.stop = stop;
  query.is_valid = [&](const JointVectord& part) {
    return !still.first_hit(full_posture(task, part));
  };
  query.is_motion_valid = [&](const JointVectord& a, const JointVectord& b) {
    return still.is_motion_clear(full_posture(task, a), full_posture(task, b));
  };
  const PathAnswer answer = task.planner(query);
  if (answer.outcome == PathOutcome::Stopped) {
    result.status = ApproachStatus::TimeOut;
    result.detail = "stopped while the path was planned";
    return {};
  }
  if (answer.outcome == PathOutcome::NotFound) {
    result.detail = fmt::format("{} found no path in {} iterations", task.problem.approach.planner,
                                task.problem.approach.max_iterations);
    return {};
  }
  std::vector<JointVectord> points;
  for (const JointVectord& part : answer.points) points.push_back(full_posture(task, part));
  points.front() = task.start;
  points.back() = task.goal.phi;
  return points;
}

/// The path with its time law, from time 0. Empty: see result.
JointPath plan_path(const ApproachTask& task, const AttemptOptions& options,
                    const StillScene& still, const StopCondition& stop, AttemptResult& result) {
  const ApproachSpec& spec = task.problem.approach;
  if (spec.base == BaseMode::ReactionNull) {
    NullPathQuery query;
    query.start = task.start;
    query.goal = task.goal.phi;
    query.goal_near = [&](const JointVectord& phi, ContactSolve how) {
      return task.contact.near_posture ? task.contact.near_posture(phi, how)
                                       : std::optional<Configuration>(task.goal);
    };
    query.measure = [&](const Configuration& end) {
      return task.contact.measure ? task.contact.measure(end) : 0.0;
    };
    query.free = task.free;
    set_bounds(task, query.lower, query.upper);
    query.seed = options.seed;
    query.max_iterations = options.max_iterations;
    query.stop = stop;
    const NullPathAnswer answer = plan_null_path(query, task.problem, still);
    result.way_points = answer.curve.times.size();
    if (answer.curve.times.empty()) {
      result.status =
          answer.stopped ? ApproachStatus::TimeOut : ApproachStatus::UnreachableInBaseMode;
      result.detail = answer.detail;
      return {};
    }
    result.end = answer.end;
    result.has_end = true;
    return time_curve(answer.curve, task.max_rate, spec.acceleration_limit);
  }
  const std::vector<JointVectord> points = plan_points(task, options, still, stop, result);
  result.way_points = points.size();
  if (points.empty()) return {};
  return time_path(
      points, task.max_rate, spec.acceleration_limit,
      [&](const JointVectord& a, const JointVectord& b) { return still.is_motion_clear(a, b); });
}

}  // namespace

void finish_motion(const ApproachTask& task, JointPath path, double wait, AttemptResult& result) {
  const ApproachSpec& spec = task.problem.approach;
  result.status = ApproachStatus::GoalUnreachable;
  Configuration end = result.has_end ? result.end : task.goal;
  if (task.starts_where_it_stands()) {
    ClosedPath closed = close_path(task.problem, path, task.goal.base, task.contact);
    if (!closed.closed) {
      result.status = ApproachStatus::BaseDriftOpen;
      result.detail = std::isfinite(closed.open)
                          ? fmt::format(
                                "no posture on the path's way meets the target where the "
                                "path leaves the base: {:.3g} m or rad stay open",
                                closed.open)
                          : "where the path leaves the base no posture meets the target";
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
  slow_for_effort(task.problem, path);
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

AttemptResult try_approach(const ApproachTask& task, const AttemptOptions& options,
                           const StopCondition& stop) {
  AttemptResult result;
  const StillScene still(task.problem, task.scene, task.goal,
                         avoidable(task, options.targets, options.resolution), options.resolution);
  const JointPath path = plan_path(task, options, still, stop, result);
  if (path.times.empty()) return result;
  finish_motion(task, path, options.wait, result);
  if (result.status == ApproachStatus::Found) polish(task, options.wait, stop, result);
  return result;
}

}  // namespace stillbase
