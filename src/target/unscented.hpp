// The unscented transform of an estimate's covariance.
#pragma once

namespace stillbase {

/// n + kappa: points lie at sqrt(kSpread) deviations.
inline constexpr double kSpread = 3;

}  // namespace stillbase
