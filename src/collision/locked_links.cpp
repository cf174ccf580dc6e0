#include "collision/locked_links.hpp"

#include <algorithm>

namespace stillbase {

namespace {

/// The joints that move at the start posture, the locked ones where they are locked.
JointVectord posture_of(const CaptureProblem& problem, const UnlockedRobot& unlocked) {
  JointVectord phi = JointVectord::Zero(unlocked.robot.n());
  for (int k = 0; k < unlocked.robot.n(); ++k) {
    const std::string& name = unlocked.robot.joints[static_cast<std::size_t>(k)].name;
    const auto at = unlocked.locked.find(name);
    if (at != unlocked.locked.end()) {
      phi[k] = at->second;
    } else if (const int free = find_joint(problem.robot, name); free >= 0) {
      phi[k] = problem.start[free];
    }
  }
  return phi;
}

}  // namespace

std::optional<Proximity> overlap_of_locked_links(const CaptureProblem& problem,
                                                 const UnlockedRobot& unlocked) {
  if (unlocked.locked.empty()) return std::nullopt;
  const RobotModel& robot = unlocked.robot;
  const auto kinematics = compute_kinematics<double>(robot, posture_of(problem, unlocked));
  // B has its origin at the centroid of the base with all that is merged into it.
  const auto root_of = [&](const RobotModel& model) -> Vector3d {
    return find_link(model, robot.base.name)->pose.position;
  };
  const Vector3d shift = root_of(robot) - root_of(problem.robot);
  for (int body = kBase; body < problem.robot.num_bodies(); ++body) {
    RobotModel part = robot;
    std::erase_if(part.shapes, [&](const CollisionShape& shape) {
      return find_link(problem.robot, shape.link)->body != body;
    });
    SceneParts parts;
    parts.allowed_contacts = problem.allowed_contacts;
    for (const Obstacle& obstacle : problem.obstacles) {
      if (body != kBase || obstacle.frame != Frame::Base) continue;
      parts.obstacles.push_back(obstacle);
      parts.obstacles.back().pose.position += shift;
    }
    if (auto hit = CollisionScene(part, parts).first_hit(kinematics, Pose{}, nullptr)) return hit;
  }
  return std::nullopt;
}

}  // namespace stillbase
