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

/// A box somewhere in space.
struct PlacedBox {
  Vector3d half = Vector3d::Zero();   ///< half edges, m
  Matrix3d R = Matrix3d::Identity();  ///< its axes
  Vector3d p = Vector3d::Zero();      ///< its centre, m
};

/// Signed distance of a sphere or capsule from a box: negative when they overlap, its size then
/// means nothing.
double round_box_distance(const RoundSegment& round, const PlacedBox& box);

/// The widest gap between two boxes along a separating axis, m: their distance where a face or two
/// edges decide, smaller where corners do, negative when they overlap.
double widest_gap(const PlacedBox& a, const PlacedBox& b);

/// Distance of two boxes that do not overlap: the least between corners and boxes and between
/// edges.
/// @pre they do not overlap
double separate_box_distance(const PlacedBox& a, const PlacedBox& b);

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

/// A box that holds the shape, along the axes of its frame.
struct BoundingBox {
  Vector3d centre = Vector3d::Zero();
  Vector3d half = Vector3d::Zero();  ///< half edges
};
BoundingBox bounding_box(const Geometry& geometry);

/// A lower bound of the distance of two boxes, 0 when they overlap: the distance of each from the
/// box along its axes that holds the other one, the larger of the two.
double box_gap(const PlacedBox& a, const PlacedBox& b);

/// Sizes finite and positive (a capsule's length may be 0), meshes with four or more
/// finite vertices and valid faces.
bool is_valid(const Geometry& geometry);

}  // namespace stillbase
