// A concave mesh as a few convex parts.
#pragma once

#include <vector>

#include "robot/convex_hull.hpp"
#include "robot/mesh_file.hpp"

namespace stillbase {

struct PartsOptions {
  /// A step of the distance code costs as much per part as per mesh otherwise.
  int max_parts = 12;
  /// A part is split while the mesh lies deeper than this in its hull somewhere, relative to the
  /// mesh's size (the diagonal of the box along its axes).
  double depth = 0.02;
  /// Two parts become one where that adds no more than this part of the mesh's own hull's volume.
  double worth = 0.005;
  /// Of each part. Parts are simpler than the whole: a box has 8 corners, a piece of a ring 16.
  HullOptions hull = {.max_vertices = 32, .distance = 0.005};
};

/// Convex polytopes that together hold every triangle of a mesh and, where the triangles are
/// closed, what they enclose.
///
/// Planes cut the part in whose hull the mesh lies deepest, until none is deeper than `depth` or
/// there are twice as many as allowed; then parts are joined while that costs less than `worth` or
/// there are too many. A plane lies in a large face or at an even division, along the axes of the
/// mesh, its largest faces or its principal axes; the one is taken that leaves the least volume in
/// both hulls, among equals the one that halves it. What decides is a thinned copy of a mesh of
/// many triangles; the parts are those of all. The same mesh gives the same parts, bit for bit.
///
/// A convex mesh is one part, its enclosing_hull(), and so is one whose parts would have more than
/// 0.9 of the volume of that hull.
/// @param mesh with finite vertices and at least one triangle
/// @return each hull around its part of the triangles, with the distance from that part's own hull
/// @throws std::invalid_argument as enclosing_hull()
std::vector<EnclosingHull> convex_parts(const Mesh& mesh, const PartsOptions& options = {});

}  // namespace stillbase
