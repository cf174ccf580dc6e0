// A convex polytope with few vertices around many points.
#pragma once

#include <vector>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

struct HullOptions {
  /// At least 14. A step of the distance code costs a dot product per vertex; a sphere is enclosed
  /// to 7 % of its radius with this number.
  int max_vertices = 64;
  /// Wanted distance from the convex hull of the points, relative to its size (the diagonal of the
  /// box along its axes). Fewer vertices are used where they suffice.
  double distance = 0.005;
};

struct EnclosingHull {
  ConvexMesh mesh;      ///< triangles
  double distance = 0;  ///< no point of it is farther from the convex hull of the points, m
  double volume = 0;    ///< m^3
};

/// The convex hull of points, or a polytope around it when it has more than max_vertices vertices.
///
/// Every point lies inside, to 1e-9 of the size. The polytope grows by the point that is farthest
/// outside of it, relative to its size there, and is then made larger about its centre until it
/// holds all points. Points in a plane or on a line get a thickness of 1e-4 of the size. It has no
/// convex_mesh_fault(): where rounding makes one of a hull with narrow faces, fewer points carry
/// it, and at last the box along the axes.
/// @param points at least one, finite
/// @throws std::invalid_argument when there are none, or all are the same
EnclosingHull enclosing_hull(const std::vector<Vector3d>& points, const HullOptions& options = {});

/// The convex hull of all points, however many vertices it has, for its volume and its depths: with
/// narrow faces it may have a convex_mesh_fault(). Of more than 20000 points it is not exact.
/// @throws std::invalid_argument as enclosing_hull()
EnclosingHull exact_hull(const std::vector<Vector3d>& points);

}  // namespace stillbase
