#include "collision/mounted_arms.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "collision/fcl_shape.hpp"

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
  int arm;
  const std::string& link;
  Matrix3d R;  ///< axes of the shape in B
  Vector3d p;  ///< its origin in B
  std::shared_ptr<const FclShape> fcl;
};

std::vector<PlacedShape> shapes_of_arms(const CaptureProblem& problem) {
  const auto at = compute_kinematics<double>(problem.robot, problem.start);
  std::vector<PlacedShape> placed;
  for (const CollisionShape& shape : problem.robot.shapes) {
    const int arm = arm_of(shape.link, problem.parts.arms);
    if (arm < 0) continue;
    Matrix3d R = shape.pose.orientation.toRotationMatrix();
    Vector3d p = shape.pose.position;
    if (shape.body != kBase) {
      const auto body = static_cast<std::size_t>(shape.body);
      p = at.o[body] + at.R[body] * p;
      R = at.R[body] * R;
    }
    placed.push_back({arm, shape.link, R, p, make_fcl_shape(shape.geometry)});
  }
  return placed;
}

}  // namespace

std::optional<Proximity> overlap_of_arms(const CaptureProblem& problem) {
  if (problem.parts.arms.size() < 2) return std::nullopt;
  const auto is_allowed = [&](const std::string& a, const std::string& b) {
    return std::any_of(
        problem.allowed_contacts.begin(), problem.allowed_contacts.end(),
        [&](const auto& pair) { return pair == std::pair(a, b) || pair == std::pair(b, a); });
  };
  const std::vector<PlacedShape> shapes = shapes_of_arms(problem);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t j = i + 1; j < shapes.size(); ++j) {
      const PlacedShape &a = shapes[i], &b = shapes[j];
      if (a.arm == b.arm || is_allowed(a.link, b.link)) continue;
      const double distance = fcl_distance(*a.fcl, a.R, a.p, *b.fcl, b.R, b.p);
      if (distance <= 0) return Proximity{b.link, a.link, distance};
    }
  }
  return std::nullopt;
}

}  // namespace stillbase
