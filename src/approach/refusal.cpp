#include "approach/refusal.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "approach/effort.hpp"
#include "approach/motion_check.hpp"

namespace stillbase {

namespace {

constexpr double kLimitSlack = 1e-6;  ///< rad or m: what optimizers leave outside a limit

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

}  // namespace

Approach failed(ApproachStatus status, const std::string& detail) {
  Approach approach;
  approach.status = status;
  approach.detail = detail;
  return approach;
}

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

}  // namespace stillbase
