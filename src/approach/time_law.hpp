// From waypoints to a motion: corners rounded, rates and accelerations within limits.
#pragma once

#include <vector>

#include "approach/geometric_path.hpp"

namespace stillbase {

/// A motion along the waypoints, from time 0, at rest at both ends.
///
/// Corners are replaced by parabolas as large as `is_clear` allows (the robot stops at a corner
/// that cannot be rounded); along that path the fastest speed profile is found by a forward and a
/// backward pass, then averaged over a window, which makes the acceleration continuous. The result
/// is sampled, and the samples are stretched in time by what the limits on the Hermite segments
/// demand.
/// @param points waypoints joined by straight lines; at least one; neighbours may coincide
/// @param max_rate n, > 0, may be infinite; @param max_acceleration n, > 0, finite
/// @param is_clear whether the straight line between two postures is free
JointPath time_path(const std::vector<JointVectord>& points, const JointVectord& max_rate,
                    const JointVectord& max_acceleration, const IsClear& is_clear,
                    const TimeLawOptions& options = {});

/// The same along a smooth curve: `times` are values of any parameter, `phidot` the slopes there.
JointPath time_curve(const JointPath& curve, const JointVectord& max_rate,
                     const JointVectord& max_acceleration, const TimeLawOptions& options = {});

}  // namespace stillbase
