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
  // B has its origin at the centroid of the base with all that is merged into it.
  const auto root_of = [&](const RobotModel& model) -> Vector3d {
    return find_link(model, robot.base.name)->pose.position;
  };
  const Vector3d shift = root_of(robot) - root_of(problem.robot);
  RobotModel merged = robot;
  std::erase_if(merged.shapes, [&](const CollisionShape& shape) {
    return find_link(problem.robot, shape.link)->body != kBase;
  });
  SceneParts parts;
  parts.allowed_contacts = problem.allowed_contacts;
  for (const CollisionShape& a : merged.shapes) {
    for (const CollisionShape& b : merged.shapes) {
      if (a.body != kBase && b.body != kBase) parts.allowed_contacts.emplace_back(a.link, b.link);
    }
  }
  for (const Obstacle& obstacle : problem.obstacles) {
    if (obstacle.frame != Frame::Base) continue;
    parts.obstacles.push_back(obstacle);
    parts.obstacles.back().pose.position += shift;
  }
  return CollisionScene(merged, parts)
      .first_hit(compute_kinematics<double>(robot, posture_of(problem, unlocked)), Pose{}, nullptr);
}

}  // namespace stillbase
