// FCL behind a door of our own: one shape, one distance. Finite numbers only: the packaged FCL has
// its assertions on and a NaN pose would end the process.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

class FclShape;

/// Shared and immutable: queries from several threads may use the same shape.
std::shared_ptr<const FclShape> make_fcl_shape(const Geometry& geometry);

/// Distance between two convex shapes, m; 0 when they overlap. GJK: sphere and capsule pairs exact,
/// capsule against box better than 1e-6 m. Where faces or edges are parallel GJK is centimetres too
/// large for boxes, meshes and cylinders: of two boxes the closed form is taken there, of other
/// pairs convex_gap() where no supporting plane proves GJK's distance, so that it is never more
/// than 1e-6 m too large.
/// @param R, p axes and origin of the shape frames in one common frame; finite
double fcl_distance(const FclShape& a, const Matrix3d& R_a, const Vector3d& p_a, const FclShape& b,
                    const Matrix3d& R_b, const Vector3d& p_b);

/// Two points, one on each of two shapes, in the common frame.
using PointPair = std::array<Vector3d, 2>;

/// The closest points of two convex shapes as GJK finds them; nothing when they overlap or touch.
/// Each lies on its shape. Where fcl_distance() mends GJK they are farther apart than it says.
/// @param R, p as of fcl_distance()
std::optional<PointPair> fcl_nearest_points(const FclShape& a, const Matrix3d& R_a,
                                            const Vector3d& p_a, const FclShape& b,
                                            const Matrix3d& R_b, const Vector3d& p_b);

}  // namespace stillbase
