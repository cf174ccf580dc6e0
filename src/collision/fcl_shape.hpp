// FCL behind a door of our own: one shape, one distance. Finite numbers only: the packaged FCL has
// its assertions on and a NaN pose would end the process.
#pragma once

#include <memory>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

class FclShape;

/// Shared and immutable: queries from several threads may use the same shape.
std::shared_ptr<const FclShape> make_fcl_shape(const Geometry& geometry);

/// Distance between two convex shapes, m; 0 when they overlap. GJK: sphere and capsule pairs exact,
/// capsule against box better than 1e-6 m, box against box up to half a millimetre too large.
/// @param R, p axes and origin of the shape frames in one common frame; finite
double fcl_distance(const FclShape& a, const Matrix3d& R_a, const Vector3d& p_a, const FclShape& b,
                    const Matrix3d& R_b, const Vector3d& p_b);

}  // namespace stillbase
