// From waypoints to a motion: corners rounded, rates and accelerations within limits.
#pragma once

#include <functional>
#include <vector>

#include <stillbase/approach/options.hpp>

#include "approach/joint_path.hpp"

namespace stillbase {

/// Whether the straight line between two postures is free.
using IsClear = std::function<bool(const JointVectord&, const JointVectord&)>;

/// A motion along the waypoints, from time 0, at rest at both ends.
///
/// Corners are replaced by parabolas as large as `is_clear` allows (the robot stops at a corner
/// that cannot be rounded). Along that path a forward and a backward pass find the fastest speed
/// profile, which is then averaged over a window: this makes the acceleration continuous. The
/// samples of the result are stretched in time by what the limits on the Hermite segments demand.
/// @param points waypoints joined by straight lines; at least one; neighbours may coincide
JointPath time_path(const std::vector<JointVectord>& points, const MotionLimits& limits,
                    const IsClear& is_clear, const TimeLawOptions& options = {});

/// The same along a smooth curve: `times` are values of any parameter, `phidot` the slopes there.
JointPath time_curve(const JointPath& curve, const MotionLimits& limits,
                     const TimeLawOptions& options = {});

/// A curve over its length (rad) instead of another parameter, slopes of norm 1. Samples at which
/// it stands still are left out.
JointPath over_length(const JointPath& curve);

}  // namespace stillbase
