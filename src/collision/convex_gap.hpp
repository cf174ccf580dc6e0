// Distance of two convex shapes by their supporting planes.
//
// Where FCL's GJK stops early it states too large a distance, by centimetres for meshes and boxes
// that turn about a common axis. A supporting plane proves a distance from below; the point of
// A - B nearest to the origin (Wolfe, Finding the nearest point in a polytope, Mathematical
// Programming 11, 1976) has one that proves it.
#pragma once

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// A shape and where it lies.
struct PlacedGeometry {
  const Geometry& geometry;
  const Matrix3d& R;  ///< its axes
  const Vector3d& p;  ///< its origin, m
};

/// By how much a lies beyond b along a direction, m: no more than their distance.
/// @param n unit vector
double gap_along(const PlacedGeometry& a, const PlacedGeometry& b, const Vector3d& n);

/// Distance, m, to 1e-7 or as far as it is proven; <= 0 where the shapes overlap.
/// @param from about the direction from b to a; not zero
double convex_gap(const PlacedGeometry& a, const PlacedGeometry& b, const Vector3d& from);

}  // namespace stillbase
