// Defaults that depend on what else a file states.
#pragma once

#include <stillbase/core/constants.hpp>

namespace stillbase::io {

/// Limits after the impact of a problem that states controllers and no limits: the base rate at the
/// horizon, rad/s, and the attitude change over it, rad.
inline constexpr double kDefaultBaseRate = 1 * kPi / 180;
inline constexpr double kDefaultAttitudeChange = 20 * kPi / 180;

}  // namespace stillbase::io
