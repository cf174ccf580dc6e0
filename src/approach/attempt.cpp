#include "approach/attempt.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "approach/base_motion.hpp"
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
void set_bounds(const ApproachTask& task, PathQuery& query) {
  const auto count = static_cast<Eigen::Index>(task.free.size());
  query.lower.resize(count);
  query.upper.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index k = task.free[static_cast<std::size_t>(i)];
    const Joint& joint = task.problem.robot.joints[static_cast<std::size_t>(k)];
    const double low = std::min(task.start[k], task.goal.phi[k]);
    const double high = std::max(task.start[k], task.goal.phi[k]);
    query.lower[i] = std::isfinite(joint.lower) ? std::min(joint.lower, low) : low - kTurn;
    query.upper[i] = std::isfinite(joint.upper) ? std::max(joint.upper, high) : high + kTurn;
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

/// Whether a thing of the scene is the base or fixed to it.
bool is_on_base(const CaptureProblem& problem, const std::string& name) {
  const LinkFrame* link = find_link(problem.robot, name);
  if (link != nullptr) return link->body == kBase;
  return std::any_of(problem.obstacles.begin(), problem.obstacles.end(),
                     [&](const Obstacle& obstacle) {
                       return obstacle.name == name && obstacle.frame == Frame::Base;
                     });
}

}  // namespace

std::optional<Lateness> too_slow(const ApproachTask& task, double duration, double wait) {
  const double contact = task.goal.contact_time;
  const double too_early = task.earliest_start - (contact - wait - duration);
  const double too_long = duration + wait - task.problem.approach.max_duration;
  const double seconds = std::max(too_early, too_long);
  if (seconds <= 0) return std::nullopt;
  return Lateness{seconds,
                  fmt::format("motion {:.3f} s and wait {:.3f} s before the contact at {:.3f} s: "
                              "{:.3f} s too slow {}",
                              duration, wait, contact, seconds,
                              too_early >= too_long ? "for a start after the target's estimate"
                                                    : "for the longest duration allowed")};
}

AttemptResult try_approach(const ApproachTask& task, const AttemptOptions& options,
                           const StopCondition& stop) {
  const ApproachSpec& spec = task.problem.approach;
  AttemptResult result;
  const StillScene still(task.problem, task.scene, task.goal,
                         avoidable(task, options.targets, options.resolution), options.resolution);
  const auto is_clear = [&](const JointVectord& a, const JointVectord& b) {
    return still.is_motion_clear(a, b);
  };

  std::vector<JointVectord> points = {task.start, task.goal.phi};
  if (!task.free.empty()) {
    PathQuery query;
    query.start = free_part(task, task.start);
    query.goal = free_part(task, task.goal.phi);
    set_bounds(task, query);
    query.resolution = options.resolution;
    query.seed = options.seed;
    query.max_iterations = options.max_iterations;
    query.stop = stop;
    query.is_valid = [&](const JointVectord& part) {
      return !still.first_hit(full_posture(task, part));
    };
    query.is_motion_valid = [&](const JointVectord& a, const JointVectord& b) {
      return is_clear(full_posture(task, a), full_posture(task, b));
    };
    const PathAnswer answer = task.planner(query);
    if (answer.outcome == PathOutcome::Stopped) {
      result.status = ApproachStatus::TimeOut;
      result.detail = "stopped while the path was planned";
      return result;
    }
    if (answer.outcome == PathOutcome::NotFound) {
      result.detail =
          fmt::format("{} found no path in {} iterations", spec.planner, spec.max_iterations);
      return result;
    }
    points.clear();
    for (const JointVectord& part : answer.points) points.push_back(full_posture(task, part));
    points.front() = task.start;
    points.back() = task.goal.phi;
  }
  result.way_points = points.size();

  result.motion.path = time_path(points, task.max_rate, spec.acceleration_limit, is_clear);
  JointPath& path = result.motion.path;
  const double duration = path.times.back();
  result.motion.contact_time = task.goal.contact_time;
  result.motion_end = task.goal.contact_time - options.wait;
  result.motion_start = result.motion_end - duration;
  for (double& t : path.times) t += result.motion_start;
  path.times.back() = result.motion_end;

  if (const auto lateness = too_slow(task, duration, options.wait)) {
    result.status = ApproachStatus::TooSlow;
    result.shortfall = lateness->seconds;
    result.detail = lateness->text;
    return result;
  }
  if (const auto joint = broken_limit(task, path)) {
    result.detail = "the path overshoots the limit of " + *joint;
    return result;
  }

  result.motion.base_poses = base_poses(task.problem.robot, path, spec.base, task.goal.base);
  if (const auto hit = first_hit(task.problem, task.scene, result.motion, task.target)) {
    result.hit_by_target = hit->proximity.first == kTargetName;
    result.hopeless = result.hit_by_target && spec.base == BaseMode::Held &&
                      is_on_base(task.problem, hit->proximity.second);
    result.status =
        result.hit_by_target ? ApproachStatus::HitEarly : ApproachStatus::GoalUnreachable;
    result.detail = fmt::format("{} at {:.3f} s, {:.3f} s before the contact (distance {:.4f} m)",
                                to_string(hit->proximity), hit->time,
                                task.goal.contact_time - hit->time, hit->proximity.distance);
    return result;
  }
  result.status = ApproachStatus::Found;
  return result;
}

}  // namespace stillbase
