// Distances of convex shapes by support functions: written apart from `collision` and its library.
//
// The distance of A and B is that of the origin from the set A - B. For any direction v the plane
// v'x = min over A - B of v'x separates the two, so every step of the search gives a lower bound,
// and the point of A - B that is nearest so far an upper one (Gilbert, Johnson, Keerthi 1988).
#pragma once

#include <stillbase/robot/robot_model.hpp>

namespace stillbase::verification {

/// A shape somewhere in space. The geometry must outlive it.
struct PlacedShape {
  const Geometry* geometry = nullptr;
  Matrix3d R = Matrix3d::Identity();  ///< axes of the shape's frame
  Vector3d p = Vector3d::Zero();      ///< its origin, m
};

/// A sphere around a geometry, in its own frame.
struct Ball {
  Vector3d centre = Vector3d::Zero();  ///< m
  double radius = 0;                   ///< m
};
Ball ball_around(const Geometry& geometry);

/// What is known of a distance, m. Where the shapes overlap, both are negative and say nothing
/// more.
struct DistanceBounds {
  double lower = 0, upper = 0;
};

/// Distance of two convex shapes in one common frame, bounded to 1e-9 m (shapes of metres) unless
/// the lower bound reaches `enough` before.
/// @pre poses are finite, sizes finite and positive, meshes are not empty
DistanceBounds convex_distance(const PlacedShape& a, const PlacedShape& b,
                               double enough = kInfinity);

}  // namespace stillbase::verification
