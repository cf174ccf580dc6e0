// Ranges of the numbers that problems state, in SI.
//
// They lie far beyond any capture. Within them everything is computed with finite numbers, and a
// time limit is kept; what lies outside is refused when it is read.
#pragma once

#include "io/scalars.hpp"

namespace stillbase::io {

/// Coordinates, m: a double keeps 1e-11 m of them, a hundredth of the tolerance of positions.
inline constexpr Range kPlace{.lower = -1e5, .upper = 1e5};
/// Coordinates in the frame of a body, m, and edges and radii of bodies.
inline constexpr Range kPlaceOnBody{.lower = -1e4, .upper = 1e4};
inline constexpr Range kSize{.lower = 0, .upper = 1e4, .is_lower_open = true};
/// Distances to keep, deviations of places, m.
inline constexpr Range kDistance{.lower = 0, .upper = 1e4};
inline constexpr double kFastest = 1e5;  ///< m/s, ten times the speed of an orbit
inline constexpr Range kVelocity{.lower = -kFastest, .upper = kFastest};
inline constexpr Range kSpeed{.lower = 0, .upper = kFastest};
inline constexpr Range kSpeedPositive{.lower = 0, .upper = kFastest, .is_lower_open = true};
/// Angles, rad: a thousand revolutions keep their attitude to 1e-12.
inline constexpr Range kAngle{.lower = -1e4, .upper = 1e4};
/// Angular velocities of bodies, rad/s: 1000 revolutions per minute.
inline constexpr Range kSpin{.lower = -100, .upper = 100};
inline constexpr Range kSpinSize{.lower = 0, .upper = 100};
/// Rotation of a target while its motion is computed, rad: takes half a second.
inline constexpr double kMostRotation = 1e4;
/// Instants, s, as from an estimate: a double keeps 1e-10 s of them, and with less the samples of a
/// path no longer give its accelerations.
inline constexpr Range kInstant{.lower = -1e6, .upper = 1e6};
/// Waits and motions, s: a day.
inline constexpr Range kWait{.lower = 0, .upper = 86400};
inline constexpr Range kDuration{.lower = 0, .upper = 86400, .is_lower_open = true};
/// Time for an approach, s: the planner of paths takes no less.
inline constexpr Range kApproachDuration{.lower = 1e-3, .upper = 86400};
/// Joint accelerations, rad/s^2 or m/s^2: with less, 1 rad takes longer than 17 hours.
inline constexpr Range kAcceleration{.lower = 1e-9, .upper = 1e12};
/// Used parts of a joint's rate: with less, one of 1 rad/s takes longer than a day for 5 deg.
inline constexpr Range kUsedPart{.lower = 1e-6, .upper = 1};
/// Gains of controllers, 1/s: the shortest control period is 1e-4 s.
inline constexpr Range kGain{.lower = 0, .upper = 1e4};
/// Moments of inertia, kg m^2: of each sign, as products are.
inline constexpr Range kInertia{.lower = -1e30, .upper = 1e30};
/// What belongs to joints or wheels, and limits that may be so large that they hold always.
inline constexpr Range kLarge{.lower = 0, .upper = 1e12};
inline constexpr Range kLargePositive{.lower = 0, .upper = 1e12, .is_lower_open = true};
inline constexpr Range kLargeVector{.lower = -1e12, .upper = 1e12};

}  // namespace stillbase::io
