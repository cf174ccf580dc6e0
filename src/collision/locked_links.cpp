#include "collision/locked_links.hpp"

#include <vector>

namespace stillbase {

namespace {

/// Where the joint of a body is locked, or what it follows is.
double locked_position(const UnlockedRobot& unlocked, int body) {
  const RobotModel& robot = unlocked.robot;
  const auto at = [&](const Joint& joint) { return unlocked.locked.at(joint.name); };
  if (!robot.is_coupled()) return at(robot.joints[static_cast<std::size_t>(body)]);
  const Coupling& coupling = robot.couplings[static_cast<std::size_t>(body)];
  return coupling.ratio * at(robot.joints[static_cast<std::size_t>(coupling.joint)]) +
         coupling.offset;
}

/// A posture of a robot of few joints.
struct PosedRobot {
  RobotModel robot;
  JointVectord phi;
};

/// The base and one of the bodies that locked joints hold on it; one whose joint is not on the base
/// comes behind two joints that stand still. The other bodies do not matter, and may be more than
/// the kernel takes.
PosedRobot base_and_body(const RobotModel& merged, const UnlockedRobot& unlocked, int body) {
  const RobotModel& robot = unlocked.robot;
  PosedRobot posed;
  const Joint& joint = robot.tree()[static_cast<std::size_t>(body)];
  const bool is_on_base = joint.parent == kBase;
  posed.robot.joints.push_back(is_on_base ? joint : Joint{});
  if (!is_on_base) {
    posed.robot.joints.emplace_back();
    posed.robot.joints.back().parent = 0;
  }
  posed.robot.bodies.resize(posed.robot.joints.size());
  posed.robot.moves_hand.resize(posed.robot.joints.size());
  posed.phi = JointVectord::Zero(posed.robot.n());
  if (is_on_base) {
    // B has its origin at the centroid of the base with all that is merged into it.
    const auto root_of = [&](const RobotModel& model) -> Vector3d {
      return find_link(model, robot.base.name)->pose.position;
    };
    posed.robot.joints[0].p += root_of(merged) - root_of(robot);
    posed.phi[0] = locked_position(unlocked, body);
  }
  for (std::size_t i = 0; i < robot.shapes.size(); ++i) {
    if (robot.shapes[i].body == kBase) posed.robot.shapes.push_back(merged.shapes[i]);
    if (robot.shapes[i].body != body) continue;
    posed.robot.shapes.push_back(is_on_base ? robot.shapes[i] : merged.shapes[i]);
    posed.robot.shapes.back().body = posed.robot.n() - 1;
  }
  return posed;
}

}  // namespace

std::optional<Proximity> overlap_of_locked_links(const CaptureProblem& problem,
                                                 const UnlockedRobot& unlocked) {
  if (unlocked.locked.empty()) return std::nullopt;
  SceneParts parts;
  parts.allowed_contacts = problem.allowed_contacts;
  for (const Obstacle& obstacle : problem.obstacles) {
    if (obstacle.frame == Frame::Base) parts.obstacles.push_back(obstacle);
  }
  const RobotModel& merged = problem.robot;  // its shapes are those of the other, in their order
  std::vector<bool> is_held(static_cast<std::size_t>(unlocked.robot.num_bodies()), false);
  for (std::size_t i = 0; i < merged.shapes.size(); ++i) {
    const int body = unlocked.robot.shapes[i].body;
    if (merged.shapes[i].body == kBase && body != kBase) is_held[body] = true;
  }
  for (int body = 0; body < unlocked.robot.num_bodies(); ++body) {
    if (!is_held[body]) continue;
    const PosedRobot posed = base_and_body(merged, unlocked, body);
    const auto kinematics = compute_kinematics<double>(posed.robot, posed.phi);
    if (const auto hit =
            CollisionScene(posed.robot, parts).first_hit(kinematics, Pose{}, nullptr)) {
      return hit;
    }
  }
  return std::nullopt;
}

}  // namespace stillbase
