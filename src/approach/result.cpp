#include "approach/result.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "approach/base_motion.hpp"
#include "approach/effort.hpp"

namespace stillbase {

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
  approach.effort_used = effort_used(task.problem, path, task.options.effort);
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

}  // namespace stillbase
