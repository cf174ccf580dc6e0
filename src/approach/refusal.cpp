#include "approach/refusal.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "approach/effort.hpp"
#include "approach/motion_check.hpp"

namespace stillbase {

namespace {

std::string limit_text(const ApproachTask& task, const JointVectord& phi) {
  const RobotModel& robot = task.problem.robot;
  const Joint* joint = joint_outside_limits(robot, phi, task.options.limit_slack);
  if (joint == nullptr) return "";
  return fmt::format("{} at {:.6g} is outside its limits [{:.6g}, {:.6g}]", joint->name,
                     phi[joint - robot.joints.data()], joint->lower, joint->upper);
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
  if (const std::string text = limit_text(task, task.start); !text.empty()) {
    return failed(ApproachStatus::StartInvalid, text);
  }
  if (const std::string text = limit_text(task, task.goal.phi); !text.empty()) {
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
  slow_for_effort(problem, straight, task.options.effort);
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
  const TimedMotion waiting = waiting_motion(task.goal, problem.approach.wait);
  if (const auto hit = first_hit(problem, task.scene, waiting, task.target)) {
    return failed(
        ApproachStatus::HitEarly,
        fmt::format("while the robot waits: {} at {:.3f} s, {:.3f} s before the contact",
                    to_string(hit->proximity), hit->time, task.goal.contact_time - hit->time));
  }
  return std::nullopt;
}

}  // namespace stillbase
