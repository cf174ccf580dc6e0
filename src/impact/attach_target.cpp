#include <stillbase/impact/attach_target.hpp>

#include <stdexcept>

namespace stillbase {

namespace {

Matrix3d parallel_axis(double mass, const Vector3d& c) {
  return mass * (c.squaredNorm() * Matrix3d::Identity() - c * c.transpose());
}

/// T in the frame of the body that carries the hand.
Pose target_in_body(const RobotModel& robot, const Pose& hand_target) {
  return Pose{robot.p_hand, Eigen::Quaterniond(robot.R_hand)} * hand_target;
}

/// Moves the origin of the base frame to s.
void shift_base(RobotModel& robot, const Vector3d& s) {
  robot.base.centroid -= s;
  for (auto* joints : {&robot.joints, &robot.coupled_tree}) {
    for (Joint& joint : *joints) {
      if (joint.parent == kBase) joint.p -= s;
    }
  }
  for (LinkFrame& link : robot.links) {
    if (link.body == kBase) link.pose.position -= s;
  }
  for (CollisionShape& shape : robot.shapes) {
    if (shape.body == kBase) shape.pose.position -= s;
  }
  if (robot.hand_body == kBase) robot.p_hand -= s;
}

}  // namespace

Vector3d base_shift(const RobotModel& robot, const TargetBody& target, const Pose& hand_target) {
  if (robot.hand_body != kBase) return Vector3d::Zero();
  const Vector3d c = target_in_body(robot, hand_target).position;
  return c * (target.mass / (robot.base.mass + target.mass));
}

RobotModel attach_target(RobotModel robot, const TargetBody& target, const Pose& hand_target) {
  if (!(target.mass > 0)) throw std::invalid_argument("attach_target: the target has no mass");
  const Pose T = target_in_body(robot, hand_target);
  const std::string name = target.name.empty() ? "target" : target.name;
  const bool on_base = robot.hand_body == kBase;
  Body& body = on_base ? robot.base : robot.bodies[static_cast<std::size_t>(robot.hand_body)];

  const double mass = body.mass + target.mass;
  const Vector3d centroid = (body.mass * body.centroid + target.mass * T.position) / mass;
  const Matrix3d R = T.orientation.toRotationMatrix();
  const Matrix3d inertia = body.inertia + parallel_axis(body.mass, body.centroid - centroid) +
                           R * target.inertia * R.transpose() +
                           parallel_axis(target.mass, T.position - centroid);
  body.mass = mass;
  body.centroid = centroid;
  body.inertia = (inertia + inertia.transpose()) / 2;
  body.merged_links.push_back(name);

  robot.links.push_back({name, robot.hand_body, T, robot.hand});
  for (const TargetShape& shape : target.shapes) {
    robot.shapes.push_back({robot.hand_body, name, T * shape.pose, shape.geometry});
  }
  if (on_base) {
    const Vector3d shift = robot.base.centroid;
    shift_base(robot, shift);
    robot.base.centroid.setZero();  // by definition of B; the difference above may leave a rounding
  }
  return robot;
}

RobotModel attach_target(RobotModel robot, const Pose& hand, const TargetBody& target,
                         const Pose& target_pose) {
  return attach_target(std::move(robot), target, hand.inverse() * target_pose);
}

}  // namespace stillbase
