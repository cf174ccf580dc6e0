#include "formulation/constraints/clearance_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/rotation.hpp>

#include "formulation/constraints/clearance_kernel.hpp"
#include "plan/allowed_contacts.hpp"

namespace stillbase {

namespace {

/// Shapes that come this close to a joint's origin count as reaching it, m.
constexpr double kReachesJoint = 1e-6;

std::optional<ClearanceShape> shape_of(int body, const std::string& name, const Pose& pose,
                                       const Geometry& geometry) {
  ClearanceShape out;
  out.body = body;
  out.name = name;
  out.R = pose.orientation.toRotationMatrix();
  out.p = pose.position;
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
    out.radius = sphere->radius;
  } else if (const auto* capsule = std::get_if<Capsule>(&geometry)) {
    out.radius = capsule->radius;
    out.half.z() = capsule->length / 2;
  } else if (const auto* cylinder = std::get_if<Cylinder>(&geometry)) {
    out.radius = cylinder->radius;
    out.half = Vector3d(cylinder->radius, cylinder->radius, cylinder->length / 2);
    out.is_cylinder = true;
  } else if (const auto* box = std::get_if<Box>(&geometry)) {
    out.is_box = true;
    out.half = box->size / 2;
  } else {
    return std::nullopt;
  }
  return out;
}

bool reaches(const ClearanceShape& shape, const Vector3d& point) {
  const Vector3d p = shape.R.transpose() * (point - shape.p);
  const Vector3d nearest(0, 0, std::clamp(p.z(), -shape.half.z(), shape.half.z()));
  const bool in_box = closed_form::box_distance(p, shape.half) <= kReachesJoint;
  const bool in_round = (p - nearest).norm() - shape.radius <= kReachesJoint;
  return (in_box || !shape.may_count_as(true)) && (in_round || !shape.may_count_as(false));
}

/// The shapes of a joint's child and parent are no farther apart than `distance` wherever the joint
/// stands, looked at in 64 positions of its range.
bool are_always_within(double distance, const Joint& joint, const ClearanceShape& child,
                       const ClearanceShape& parent) {
  constexpr int kPositions = 64;
  const double low = std::isfinite(joint.lower) ? joint.lower : -kPi;
  const double high = std::isfinite(joint.upper) ? joint.upper : kPi;
  for (int i = 0; i < kPositions; ++i) {
    const double phi = low + (high - low) * i / (kPositions - 1);
    const Vector3d along(0, 0, phi);
    const Matrix3d turn = joint.is_prismatic() ? Matrix3d(Matrix3d::Identity())
                                               : rotation_exp(along).toRotationMatrix();
    const Matrix3d R = joint.R.matrix() * turn;
    const Vector3d o = joint.p + (joint.is_prismatic() ? Vector3d(joint.R.matrix() * along)
                                                       : Vector3d(Vector3d::Zero()));
    const PlacedShape<double> a{&child, R * child.R, o + R * child.p};
    const PlacedShape<double> b{&parent, parent.R, parent.p};
    if (separate<double>(a, b).distance > distance) return false;
  }
  return true;
}

/// @param clearance that is asked for, m: no posture has it between neighbours whose closed form is
/// too small at the rim of a cylinder
bool overlap_at_joint(const RobotModel& robot, double clearance, const ClearanceShape& a,
                      const ClearanceShape& b) {
  const ClearanceShape& child = a.body > b.body ? a : b;
  const ClearanceShape& parent = a.body > b.body ? b : a;
  if (child.body < 0 || parent.body == kTargetBody) return false;
  const Joint& joint = robot.tree()[static_cast<std::size_t>(child.body)];
  if (joint.parent != parent.body) return false;
  const bool both_reach = reaches(child, Vector3d::Zero()) && reaches(parent, joint.p);
  const double least = child.is_cylinder || parent.is_cylinder ? clearance : 0;
  return both_reach || are_always_within(least, joint, child, parent);
}

}  // namespace

std::vector<ClearancePair> clearance_pairs(const CaptureProblem& problem) {
  const RobotModel& robot = problem.robot;
  struct Numbered {
    int number;
    bool is_obstacle;
    ClearanceShape shape;
  };
  std::vector<Numbered> shapes;
  int number = 0;
  const auto add = [&](int body, const std::string& name, const Pose& pose,
                       const Geometry& geometry, bool is_obstacle, bool is_left_out) {
    ++number;
    const auto shape = shape_of(body, name, pose, geometry);
    if (shape && !is_left_out) shapes.push_back({number, is_obstacle, *shape});
  };
  for (const CollisionShape& shape : robot.shapes) {
    add(shape.body, shape.link, shape.pose, shape.geometry, false, false);
  }
  for (const Obstacle& obstacle : problem.obstacles) {
    add(kBase, obstacle.name, obstacle.pose, obstacle.geometry, true,
        obstacle.frame == Frame::Inertial);
  }
  if (problem.target) {
    for (const TargetShape& shape : problem.target->shapes) {
      add(kTargetBody, "target", shape.pose, shape.geometry, false, false);
    }
  }
  std::vector<ClearancePair> out;
  for (std::size_t j = 0; j < shapes.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const ClearanceShape& a = shapes[i].shape;
      const ClearanceShape& b = shapes[j].shape;
      const bool hand_meets_target = b.body == kTargetBody && a.body == robot.hand_body;
      if (a.body == b.body || hand_meets_target) continue;
      if (is_allowed(problem.allowed_contacts, a.name, b.name)) continue;
      if (!shapes[i].is_obstacle && !shapes[j].is_obstacle &&
          overlap_at_joint(robot, problem.constraints.clearance.value_or(0), a, b)) {
        continue;
      }
      out.push_back({a, b,
                     "clearance_" + std::to_string(shapes[i].number) + "_" +
                         std::to_string(shapes[j].number) + "_" + a.name + "_" + b.name});
    }
  }
  return out;
}

}  // namespace stillbase
