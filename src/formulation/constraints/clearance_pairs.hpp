// Which shapes a clearance constraint keeps apart at the contact, in closed form.
//
// Exact between spheres, capsules and boxes that are apart. Two boxes that overlap have their gap
// along the best of the 15 separating axes, and so have those about cylinders. A cylinder counts as
// the intersection of the capsule and the box about it with the larger of their two distances: a
// lower bound, exact where its side or an end is nearest. Left to the judgement of `planner` alone:
// convex meshes and obstacles fixed in N.
#pragma once

#include <string>
#include <vector>

#include <stillbase/plan/problem.hpp>

namespace stillbase {

inline constexpr int kTargetBody = -2;  ///< carrier of the target's shapes

/// A box, everything within `radius` of a segment along z (a point for a sphere), or a cylinder:
/// the part of both.
struct ClearanceShape {
  int body = kBase;                   ///< index of a body, kBase or kTargetBody
  std::string name;                   ///< link, obstacle or "target"
  Matrix3d R = Matrix3d::Identity();  ///< axes of the shape in its body's frame
  Vector3d p = Vector3d::Zero();      ///< origin there, m
  bool is_box = false;
  bool is_cylinder = false;          ///< with its segment, its radius and the box about both
  Vector3d half = Vector3d::Zero();  ///< half edges of the box; z: half length of the segment, m
  double radius = 0;                 ///< m

  /// Its axes are not those of the body.
  bool is_turned() const { return R != Matrix3d::Identity(); }
  /// Which closed forms it has: that of a box, that of what is round.
  bool may_count_as(bool box) const { return is_cylinder || box == is_box; }
  /// No point is further from the origin, m; of a cylinder no point of its capsule.
  double reach() const { return is_box ? half.norm() : half.z() + radius; }
};

struct ClearancePair {
  ClearanceShape first, second;
  std::string name;  ///< of the constraint
};

/// The pairs that may not touch at the contact: shapes of different bodies, without those named in
/// allowed_contacts, the hand's body with the target, and neighbours that overlap at their joint by
/// construction or, where one is a cylinder, are closer than the clearance wherever it stands.
/// Shapes are numbered from 1: the robot's, the obstacles, the target's.
std::vector<ClearancePair> clearance_pairs(const CaptureProblem& problem);

}  // namespace stillbase
