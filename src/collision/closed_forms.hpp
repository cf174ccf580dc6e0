// Distances and extents of simple shapes in closed form.
#pragma once

#include <optional>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// A segment swollen by a radius: a sphere (both ends equal) or a capsule.
struct RoundSegment {
  Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();  ///< ends, m
  double radius = 0;                                    ///< m
};

/// Distance between two segments. Ends may coincide; parallel segments included.
double segment_distance(const Vector3d& a0, const Vector3d& a1, const Vector3d& b0,
                        const Vector3d& b1);

/// Signed distance of spheres and capsules: negative when they overlap.
double round_distance(const RoundSegment& a, const RoundSegment& b);

/// The segment and radius of a sphere or capsule in its own frame; nothing for other shapes.
std::optional<RoundSegment> round_segment(const Geometry& geometry);

/// Distance of a point from a shape, both in the shape's frame; 0 inside. For a convex mesh the
/// largest distance from a face plane, which is a lower bound.
double point_distance(const Geometry& geometry, const Vector3d& point);

/// A sphere that holds the shape, in its own frame.
struct BoundingSphere {
  Vector3d centre = Vector3d::Zero();
  double radius = 0;
};
BoundingSphere bounding_sphere(const Geometry& geometry);

/// Sizes finite and positive (a capsule's length may be 0), meshes with four or more
/// finite vertices and valid faces.
bool is_valid(const Geometry& geometry);

}  // namespace stillbase
