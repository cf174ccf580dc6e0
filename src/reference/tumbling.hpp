// Torque-free rotation a second time: power series of Euler's equations in the body's axes and of
// the attitude, each coefficient from the ones before. Shares nothing with `target`, which
// integrates the attitude alone under a constant angular momentum.
#pragma once

#include <optional>

#include <Eigen/Geometry>
#include <stillbase/core/interrupt.hpp>

namespace stillbase::reference {

/// A rotating body at one instant.
struct Tumbling {
  Eigen::Quaterniond R_NT = Eigen::Quaterniond::Identity();
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();  ///< in T, rad/s
};

/// The same body `duration` (s, of either sign) later:
///   I omega' + omega x I omega = 0,  q' = q omega / 2.
/// Steps turn the body by a quarter of the distance to the nearest singularity that the elliptic
/// functions of the solution can have, so that each series ends below the rounding error.
/// @param inertia about the centroid in T, kg m^2, positive definite
/// @return empty when `stop` came first
std::optional<Tumbling> tumble(const Eigen::Matrix3d& inertia, const Tumbling& from,
                               double duration, const StopCondition& stop = {});

}  // namespace stillbase::reference
