#include <stillbase/approach/approach.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/random.hpp>

#include "approach/attempt.hpp"
#include "approach/base_motion.hpp"
#include "approach/closure.hpp"
#include "approach/effort.hpp"
#include "approach/time_law.hpp"

namespace stillbase {

namespace {

constexpr double kTurn = 6.283185307179586;
constexpr double kLimitSlack = 1e-6;  ///< rad or m: what optimizers leave outside a limit
constexpr int kAttempts = 8;
constexpr int kSweptEffort = 5;  ///< part of the planner's iterations spent around those
constexpr int kSweptPoses = 8;   ///< target poses during a motion that was hit, taken as obstacles

bool is_finite(const Pose& pose) {
  return pose.position.allFinite() && pose.orientation.coeffs().allFinite();
}

/// Numbers that the reader should have refused never get further than here.
void check_input(const CaptureProblem& problem, const Configuration& goal) {
  const ApproachSpec& spec = problem.approach;
  const int n = problem.robot.n();
  const auto demand = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("approach: ") + what);
  };
  demand(problem.start.size() == n && goal.phi.size() == n && spec.acceleration_limit.size() == n,
         "start, goal and acceleration limit need one number per joint");
  demand(problem.start.allFinite() && goal.phi.allFinite() && is_finite(goal.base) &&
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

JointVectord wrapped_start(const CaptureProblem& problem, const Configuration& goal) {
  JointVectord start = problem.start;
  for (int k = 0; k < problem.robot.n(); ++k) {
    if (problem.robot.joints[static_cast<std::size_t>(k)].type == JointType::Continuous) {
      start[k] += kTurn * std::round((goal.phi[k] - start[k]) / kTurn);
    }
  }
  return start;
}

ApproachTask make_task(const CaptureProblem& problem, const Configuration& goal,
                       const TargetMotion* target, const ContactSolver& contact) {
  check_input(problem, goal);
  const int n = problem.robot.n();
  ApproachTask task{problem,
                    goal,
                    target,
                    CollisionScene(problem),
                    find_path_planner(problem.approach.planner),
                    wrapped_start(problem, goal),
                    JointVectord(n),
                    {},
                    -kInfinity,
                    contact};
  if (task.starts_where_it_stands() && !contact.at_base) {
    throw std::invalid_argument(
        "approach: a floating base with a stated start needs someone to solve the contact anew");
  }
  for (int k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(k);
    task.max_rate[k] = problem.robot.joints[i].max_velocity * problem.approach.velocity_scale;
    const bool may_move = problem.variables.joints.empty() || problem.variables.joints[i];
    if (may_move || task.start[k] != goal.phi[k]) task.free.push_back(k);
  }
  // A predicted target is known from its estimate on; one that is only said to come from some
  // direction has come along forever.
  if (target != nullptr && !problem.impulse.direction) {
    task.earliest_start = problem.target_state.time;
  }
  return task;
}

std::string limit_text(const RobotModel& robot, const JointVectord& phi) {
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    if (phi[k] < joint.lower - kLimitSlack || phi[k] > joint.upper + kLimitSlack) {
      return fmt::format("{} at {:.6g} is outside its limits [{:.6g}, {:.6g}]", joint.name, phi[k],
                         joint.lower, joint.upper);
    }
  }
  return "";
}

std::string clearance_text(const Proximity& hit, double clearance) {
  return fmt::format("{}: distance {:.4f} m, clearance {:.4f} m asked for", to_string(hit),
                     std::max(hit.distance, 0.0), clearance);
}

Approach failed(ApproachStatus status, const std::string& detail) {
  Approach approach;
  approach.status = status;
  approach.detail = detail;
  return approach;
}

JointPath straight_path(const ApproachTask& task) {
  return time_path({task.start, task.goal.phi}, task.max_rate,
                   task.problem.approach.acceleration_limit,
                   [](const JointVectord&, const JointVectord&) { return true; });
}

/// Start, goal, the wait and the time that even a straight line needs do not depend on the path:
/// refused before any planning.
std::optional<Approach> refuse(const ApproachTask& task) {
  const CaptureProblem& problem = task.problem;
  const double clearance = problem.approach.clearance;
  if (const std::string text = limit_text(problem.robot, task.start); !text.empty()) {
    return failed(ApproachStatus::StartInvalid, text);
  }
  if (const std::string text = limit_text(problem.robot, task.goal.phi); !text.empty()) {
    return failed(ApproachStatus::GoalInvalid, text);
  }
  const StillScene alone(problem, task.scene, task.goal, {}, problem.approach.resolution);
  if (const auto hit = alone.first_hit(task.start)) {
    return failed(ApproachStatus::StartInvalid, clearance_text(*hit, clearance));
  }
  if (const auto hit = alone.first_hit(task.goal.phi)) {
    return failed(ApproachStatus::GoalInvalid, clearance_text(*hit, clearance));
  }
  JointPath straight = straight_path(task);
  slow_for_effort(problem, straight);
  if (const auto lateness =
          too_slow(task, task.goal.contact_time, straight.times.back(), problem.approach.wait)) {
    Approach late = failed(ApproachStatus::TooSlow, lateness->text);
    late.late_by = lateness->seconds;
    return late;
  }
  if (task.target == nullptr) return std::nullopt;
  const Pose at_contact = task.target->state(task.goal.contact_time).pose;
  const StillScene contact(problem, task.scene, task.goal, {at_contact},
                           problem.approach.resolution);
  if (const auto hit = contact.first_hit(task.goal.phi)) {
    return failed(ApproachStatus::GoalInvalid, "at the contact " + clearance_text(*hit, clearance));
  }
  TimedMotion waiting;
  waiting.contact_time = task.goal.contact_time;
  waiting.path.times = {task.goal.contact_time - problem.approach.wait};
  waiting.path.phi = {task.goal.phi};
  waiting.path.phidot = {JointVectord::Zero(problem.robot.n())};
  waiting.base_poses = {task.goal.base};
  if (const auto hit = first_hit(problem, task.scene, waiting, task.target)) {
    return failed(
        ApproachStatus::HitEarly,
        fmt::format("while the robot waits: {} at {:.3f} s, {:.3f} s before the contact",
                    to_string(hit->proximity), hit->time, task.goal.contact_time - hit->time));
  }
  return std::nullopt;
}

/// Under which name the planner's runs are counted.
std::string planner_name(const CaptureProblem& problem) {
  return problem.approach.base == BaseMode::ReactionNull ? "reaction_null"
                                                         : problem.approach.planner;
}

Approach finished(const ApproachTask& task, const AttemptResult& attempt, int tries, double wait) {
  const RobotModel& robot = task.problem.robot;
  const TimedMotion& motion = attempt.motion;
  const JointPath& path = motion.path;
  Approach approach;
  approach.status = ApproachStatus::Found;
  approach.times = path.times;
  approach.joint_positions = path.phi;
  approach.joint_velocities = path.phidot;
  approach.base_poses = motion.base_poses;
  const Pose& end = motion.base_poses.back();
  for (std::size_t i = 0; i < path.segments(); ++i) {
    const JointMotion at = motion_on_segment(path, i, path.times[i]);
    approach.joint_accelerations.push_back(at.phiddot);
    approach.joint_torques.push_back(joint_torques(task.problem, at));
  }
  approach.joint_accelerations.push_back(JointVectord::Zero(robot.n()));
  approach.joint_torques.push_back(JointVectord::Zero(robot.n()));
  approach.effort_used = effort_used(task.problem, path);
  for (std::size_t i = 0; i < path.times.size(); ++i) {
    approach.base_velocities.push_back(
        task.problem.approach.base == BaseMode::Held
            ? Vector6d(Vector6d::Zero())
            : base_velocity(robot, {path.phi[i], path.phidot[i], path.phidot[i]}));
    approach.attitude_excursion = std::max(
        approach.attitude_excursion,
        rotation_log(end.orientation.conjugate() * motion.base_poses[i].orientation).norm());
  }
  const auto hand_at = [&](const JointVectord& phi, const Pose& base) {
    const auto kinematics = compute_kinematics<double>(robot, phi);
    return base * Pose{kinematics.r_bh, Eigen::Quaterniond(kinematics.R_hand)};
  };
  const Pose hand = hand_at(path.phi.back(), end);
  const Pose wanted = hand_at(attempt.end.phi, attempt.end.base);
  approach.hand_position_error = (hand.position - wanted.position).norm();
  approach.hand_angle_error =
      rotation_log(wanted.orientation.conjugate() * hand.orientation).norm();
  approach.polish = task.problem.approach.polish;
  approach.before_polish = attempt.before_polish;
  approach.after_polish = attempt.after_polish;
  approach.duration = path.times.back() - path.times.front();
  approach.path_length = length(path);
  const Proximity closest = smallest_clearance(task.problem, task.scene, motion,
                                               attempt.target ? &*attempt.target : nullptr);
  approach.min_clearance = closest.distance;
  if (motion.contact_time > path.times.back()) {
    approach.times.push_back(motion.contact_time);
    approach.joint_positions.push_back(path.phi.back());
    approach.joint_velocities.push_back(JointVectord::Zero(robot.n()));
    approach.joint_accelerations.push_back(JointVectord::Zero(robot.n()));
    approach.joint_torques.push_back(JointVectord::Zero(robot.n()));
    approach.base_poses.push_back(motion.base_poses.back());
    approach.base_velocities.push_back(Vector6d::Zero());
  }
  approach.detail =
      fmt::format("{} way points by {} in {} {}; moves for {:.3f} s, waits for {:.3f} s",
                  attempt.way_points, planner_name(task.problem), tries,
                  tries == 1 ? "attempt" : "attempts", approach.duration, wait);
  approach.detail +=
      std::isfinite(closest.distance)
          ? fmt::format("; closest: {}, {:.4f} m", to_string(closest), closest.distance)
          : "; no pair of bodies that could collide";
  return approach;
}

/// Poses of the target while an earlier attempt moved.
std::vector<Pose> swept_poses(const AttemptResult& attempt) {
  std::vector<Pose> poses;
  for (int i = 0; i < kSweptPoses; ++i) {
    const double t =
        attempt.motion_end + (attempt.motion_start - attempt.motion_end) * i / (kSweptPoses - 1);
    poses.push_back(attempt.target->state(t).pose);
  }
  return poses;
}

/// What to report when every attempt fails: a hit rather than being late, the least delay.
bool is_better_news(const AttemptResult& result, const AttemptResult& known) {
  if (known.detail.empty()) return true;
  if (result.status == ApproachStatus::TooSlow) {
    return known.status == ApproachStatus::TooSlow && result.shortfall < known.shortfall;
  }
  return result.way_points > 0;
}

/// The target as a still obstacle where it will be at the arrival.
std::vector<Pose> arrival_pose(const ApproachTask& task, double wait) {
  if (task.target == nullptr) return {};
  return {task.target->state(task.goal.contact_time - wait).pose};
}

/// What the next attempt does differently, beside its random stream.
void learn(const ApproachTask& task, const AttemptResult& result, int attempt,
           AttemptOptions& options) {
  options.max_iterations = task.problem.approach.max_iterations;
  if (attempt + 1 == kAttempts) {  // last resort: nothing still to avoid, judged in time alone
    options.wait = task.problem.approach.wait;
    options.targets.clear();
  } else if (result.hit_by_target) {
    options.targets = swept_poses(result);
    // More cautious than need be, and often without a solution: not worth the full effort.
    options.max_iterations = std::max(1, options.max_iterations / kSweptEffort);
    if (attempt % 3 == 0) options.wait += (result.motion_end - result.motion_start) / 2;
  } else if (result.way_points == 0) {
    options.targets = arrival_pose(task, options.wait);
  } else if (result.status == ApproachStatus::TooSlow) {
    options.wait = task.problem.approach.wait;
  } else {
    options.resolution /= 2;
  }
}

Approach plan(ApproachTask& task, std::uint64_t seed, const StopCondition& stop,
              std::map<std::string, long>& solver_calls) {
  if (task.starts_where_it_stands()) {
    // Where the base ends up is not known before there is a path; the straight line tells roughly.
    const ClosedPath straight =
        close_path(task.problem, straight_path(task), task.goal.base, task.contact);
    if (straight.closed) task.goal = straight.end;
  }
  if (auto refused = refuse(task)) return *refused;
  Random seeds(seed);
  AttemptOptions options;
  options.resolution = task.problem.approach.resolution;
  options.max_iterations = task.problem.approach.max_iterations;
  options.wait = task.problem.approach.wait;
  options.targets = arrival_pose(task, options.wait);
  AttemptResult news;
  for (int attempt = 1; attempt <= kAttempts; ++attempt) {
    if (stop.reached()) return failed(ApproachStatus::TimeOut, "stopped before a path was found");
    options.seed = seeds.next();
    const AttemptResult result = try_approach(task, options, stop);
    if (!task.free.empty()) ++solver_calls[planner_name(task.problem)];
    if (result.status == ApproachStatus::Found) {
      return finished(task, result, attempt, options.wait);
    }
    if (result.status == ApproachStatus::TimeOut || result.hopeless ||
        (attempt == 1 && result.way_points == 0)) {
      return failed(result.status, result.detail);
    }
    if (is_better_news(result, news)) news = result;
    if (task.starts_where_it_stands() && result.has_end) task.goal = result.end;
    learn(task, result, attempt, options);
  }
  Approach none =
      failed(news.status, fmt::format("{} (after {} attempts)", news.detail, kAttempts));
  none.late_by = news.shortfall;
  return none;
}

}  // namespace

Approach plan_approach(const CaptureProblem& problem, const Configuration& goal,
                       const TargetMotion* target, std::uint64_t seed, const StopCondition& stop,
                       std::map<std::string, long>& solver_calls, const ContactSolver& contact) {
  if (!problem.approach.enabled) {
    return failed(ApproachStatus::NotRequested, "no approach asked for");
  }
  ApproachTask task = make_task(problem, goal, target, contact);
  try {
    return plan(task, seed, stop, solver_calls);
  } catch (const std::out_of_range&) {  // from TargetMotion
    return failed(ApproachStatus::TooSlow,
                  "motion and wait reach back beyond the horizon of the target's prediction");
  }
}

}  // namespace stillbase
