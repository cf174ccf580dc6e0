#include "collision/mounted_arms.hpp"

#include <string>
#include <vector>

#include "collision/closed_forms.hpp"
#include "collision/fcl_shape.hpp"
#include "plan/allowed_contacts.hpp"

namespace stillbase {

namespace {

/// The arm with the longest prefix that the link's name begins with; -1: the base itself.
int arm_of(const std::string& link, const std::vector<MountedArm>& arms) {
  int found = -1;
  if (link == kBaseLink) return found;
  for (std::size_t i = 0; i < arms.size(); ++i) {
    const bool is_longer =
        found < 0 || arms[i].prefix.size() > arms[static_cast<std::size_t>(found)].prefix.size();
    if (is_longer && link.starts_with(arms[i].prefix)) found = static_cast<int>(i);
  }
  return found;
}

struct PlacedShape {
  int arm;  ///< -1: the base itself
  const CollisionShape& shape;
  Matrix3d R;  ///< axes of the shape in B
  Vector3d p;  ///< its origin in B
  std::shared_ptr<const FclShape> fcl;
};

std::vector<PlacedShape> place_shapes(const CaptureProblem& problem) {
  const auto at = compute_kinematics<double>(problem.robot, problem.start);
  std::vector<PlacedShape> placed;
  for (const CollisionShape& shape : problem.robot.shapes) {
    const int arm = arm_of(shape.link, problem.parts.arms);
    Matrix3d R = shape.pose.orientation.toRotationMatrix();
    Vector3d p = shape.pose.position;
    if (shape.body != kBase) {
      const auto body = static_cast<std::size_t>(shape.body);
      p = at.o[body] + at.R[body] * p;
      R = at.R[body] * R;
    }
    placed.push_back({arm, shape, R, p, make_fcl_shape(shape.geometry)});
  }
  return placed;
}

/// Whether a body belongs to the base or moves on it.
bool is_on_base(const RobotModel& robot, int body) {
  return body == kBase || robot.tree()[static_cast<std::size_t>(body)].parent == kBase;
}

}  // namespace

std::optional<Proximity> overlap_of_arms(const CaptureProblem& problem) {
  if (problem.parts.arms.size() < 2) return std::nullopt;
  const std::vector<PlacedShape> shapes = place_shapes(problem);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t j = i + 1; j < shapes.size(); ++j) {
      const PlacedShape &a = shapes[i], &b = shapes[j];
      if (a.arm < 0 || b.arm < 0 || a.arm == b.arm) continue;
      if (is_allowed(problem.allowed_contacts, a.shape.link, b.shape.link)) continue;
      const double distance = fcl_distance(*a.fcl, a.R, a.p, *b.fcl, b.R, b.p);
      if (distance <= 0) return Proximity{b.shape.link, a.shape.link, distance};
    }
  }
  return std::nullopt;
}

std::optional<Proximity> sunk_link(const CaptureProblem& problem) {
  if (problem.parts.arms.empty()) return std::nullopt;
  const std::vector<PlacedShape> shapes = place_shapes(problem);
  for (const PlacedShape& base : shapes) {
    if (base.arm >= 0) continue;
    for (const PlacedShape& link : shapes) {
      if (link.arm < 0 || !is_on_base(problem.robot, link.shape.body)) continue;
      if (is_allowed(problem.allowed_contacts, link.shape.link, base.shape.link)) continue;
      const Vector3d middle = link.p + link.R * bounding_box(link.shape.geometry).centre;
      if (point_distance(base.shape.geometry, base.R.transpose() * (middle - base.p)) > 0) continue;
      return Proximity{link.shape.link, base.shape.link, 0};
    }
  }
  return std::nullopt;
}

}  // namespace stillbase
