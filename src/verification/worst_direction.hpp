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

/// @param n axis of the cone, unit
/// @param half_angle rad
/// @param plane_normal unit; with it the cone is the wedge that n sweeps when turned about it
/// @param samples directions before the refinement
WorstDirection worst_over_cone(const std::function<double(const Vector3d&)>& value,
                               const Vector3d& n, double half_angle,
                               const std::optional<Vector3d>& plane_normal, int samples);

}  // namespace stillbase::verification
