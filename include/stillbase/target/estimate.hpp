// One estimate of a target's motion out of a stream of them.
#pragma once

#include <optional>

#include <stillbase/target/target.hpp>

namespace stillbase {

/// Covariance of position, orientation, linear and angular velocity: the first twelve errors of
/// EstimateError, in its axes and units.
using StateCovariance = Eigen::Matrix<double, 12, 12>;

struct StateEstimate {
  TargetState state;                               ///< at state.time
  std::optional<StateCovariance> covariance = {};  ///< empty: not stated
};

}  // namespace stillbase
