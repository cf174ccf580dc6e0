// The worst value of a function over a cone of directions, by dense sampling and local refinement.
#pragma once

#include <functional>
#include <optional>

#include <stillbase/core/types.hpp>

namespace stillbase::verification {

struct WorstDirection {
  double value = 0;
  Vector3d direction = Vector3d::Zero();
};

/// The direction of a cone about n (unit) at this angle from n and this azimuth; in a wedge n
/// rotated about the plane's normal (unit) by the angle. rad
Vector3d cone_direction(const Vector3d& n, const std::optional<Vector3d>& plane_normal,
                        double angle, double azimuth);

/// @param n axis of the cone, unit
/// @param half_angle rad
/// @param plane_normal unit; with it the cone is the wedge that n sweeps when rotated about it
/// @param samples directions before the refinement
WorstDirection worst_over_cone(const std::function<double(const Vector3d&)>& value,
                               const Vector3d& n, double half_angle,
                               const std::optional<Vector3d>& plane_normal, int samples);

}  // namespace stillbase::verification
