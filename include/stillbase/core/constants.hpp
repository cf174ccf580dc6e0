// Numbers that several rooms share.
#pragma once

#include <limits>

namespace stillbase {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kPi = 3.14159265358979323846;

/// Largest violation of a feasible configuration, in the unit of each constraint. 1e-9 m or rad is
/// far below anything that a robot measures, and far above rounding.
inline constexpr double kFeasibilityTolerance = 1e-9;

/// An objective below this counts as zero, in its unit or over its typical size.
inline constexpr double kZeroObjective = 1e-9;

}  // namespace stillbase
