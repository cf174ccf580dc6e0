#include "verification/moving_shapes.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/reference/reference.hpp>

#include "verification/carrier.hpp"
#include "verification/recomputation.hpp"

namespace stillbase::verification {

MovingShapes::MovingShapes(const CaptureProblem& problem, const CollisionScene& scene)
    : problem_(problem) {
  const auto add = [&](int body, const std::string& name, const Pose& pose,
                       const Geometry& geometry) {
    shapes_.push_back({body, name, pose, &geometry, ball_around(geometry), {&geometry}});
  };
  for (const CollisionShape& shape : problem.robot.shapes) {
    add(shape.body, shape.link, shape.pose, shape.geometry);
  }
  const std::size_t robot_shapes = shapes_.size();
  for (const Obstacle& obstacle : problem.obstacles) {
    add(obstacle.frame == Frame::Base ? kBase : kInertial, obstacle.name, obstacle.pose,
        obstacle.geometry);
  }
  if (problem.target) {
    for (const TargetShape& shape : problem.target->shapes) {
      add(kOnTarget, kTargetName, shape.pose, shape.geometry);
      const Shape& added = shapes_.back();
      contact_radius_ =
          std::max(contact_radius_, (added.pose * added.ball.centre).norm() + added.ball.radius);
    }
  }
  if (const auto feature = feature_of(problem)) {
    contact_point_ = feature->point;
    contact_radius_ = 0;
  }
  for (const auto& [a, b] : scene.shape_pairs()) {
    const int body_a = shapes_[a].body, body_b = shapes_[b].body;
    const bool is_target = body_a == kOnTarget || body_b == kOnTarget;
    const std::size_t other = body_a == kOnTarget ? b : a;
    pairs_.push_back(
        {a, b, common_ancestor(body_a, body_b), std::min(body_a, body_b) >= kBase, is_target,
         is_target && other < robot_shapes && shapes_[other].body == problem.robot.hand_body});
  }
}

int MovingShapes::common_ancestor(int a, int b) const {
  // Parents have the smaller index.
  while (a != b && std::max(a, b) > kBase) {
    int& further = a > b ? a : b;
    further = problem_.robot.tree()[further].parent;
  }
  return std::max(a, b);
}

void MovingShapes::place(const Eigen::VectorXd& phi, const Pose& base, const Pose* target) {
  base_ = base;
  has_target_ = target != nullptr;
  if (target != nullptr) target_ = *target;
  bodies_ = reference::body_poses(problem_.robot, phi);
  for (Pose& body : bodies_) body = base * body;
  const auto carrier = [&](int body) {
    if (body == kInertial) return Pose{};
    if (body == kOnTarget) return target_;
    return body == kBase ? base_ : bodies_[body];
  };
  for (Shape& shape : shapes_) {
    const Pose pose = carrier(shape.body) * shape.pose;
    shape.placed.R = pose.orientation.toRotationMatrix();
    shape.placed.p = pose.position;
    shape.centre = shape.placed.R * shape.ball.centre + pose.position;
  }
  hand_ = carrier(problem_.robot.hand_body) * problem_.robot.p_hand;
}

std::string MovingShapes::name(int pair) const {
  return shapes_[pairs_[pair].a].name + " with " + shapes_[pairs_[pair].b].name;
}

double MovingShapes::hand_room() const {
  const double distance = (hand_ - target_ * contact_point_).norm() - contact_radius_;
  return problem_.approach.contact_allowance - std::max(distance, 0.0);
}

double MovingShapes::hand_motion(const PathTravel& travel) const {
  return motion_in_N(problem_.robot.hand_body, hand_, 0, travel) +
         motion_in_N(kOnTarget, target_ * contact_point_, 0, travel);
}

DistanceBounds MovingShapes::distance(int pair, double enough) const {
  const Shape &a = shapes_[pairs_[pair].a], &b = shapes_[pairs_[pair].b];
  const double apart = (a.centre - b.centre).norm() - a.ball.radius - b.ball.radius;
  if (apart >= enough) return {apart, kInfinity};
  return convex_distance(a.placed, b.placed, enough);
}

// The joints are brought from the instant to another one by one, the outermost first: it moves the
// shape's points by its angle times their distance from its axis. The next one inward is still
// where it was at the instant, and the points are further from its axis by no more than that.
double MovingShapes::motion_below(int ancestor, int body, const Vector3d& centre, double radius,
                                  const Eigen::VectorXd& joints) const {
  const RobotModel& robot = problem_.robot;
  double moved = 0;
  for (int k = body; k != ancestor; k = robot.tree()[k].parent) {
    const double ratio = robot.is_coupled() ? std::abs(robot.couplings[k].ratio) : 1;
    const double travel = ratio * joints[robot.coordinate(k)];
    const Vector3d axis = bodies_[k].orientation * Vector3d::UnitZ();
    const double lever = (centre - bodies_[k].position).cross(axis).norm() + radius;
    moved += robot.tree()[k].is_prismatic() ? travel : travel * (lever + moved);
  }
  return moved;
}

double MovingShapes::motion_in_N(int body, const Vector3d& centre, double radius,
                                 const PathTravel& travel) const {
  if (body == kInertial) return 0;
  if (body == kOnTarget) {
    return travel.target_translation +
           travel.target_rotation * ((centre - target_.position).norm() + radius);
  }
  const double moved = motion_below(kBase, body, centre, radius, travel.joints);
  return moved + travel.base.translation +
         travel.base.rotation * ((centre - base_.position).norm() + radius + moved);
}

double MovingShapes::motion(int pair, const PathTravel& travel) const {
  const Pair& of = pairs_[pair];
  double sum = 0;
  for (const std::size_t i : {of.a, of.b}) {
    const Shape& shape = shapes_[i];
    sum += of.on_robot ? motion_below(of.ancestor, shape.body, shape.centre, shape.ball.radius,
                                      travel.joints)
                       : motion_in_N(shape.body, shape.centre, shape.ball.radius, travel);
  }
  return sum;
}

}  // namespace stillbase::verification
