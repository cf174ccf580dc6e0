// Derivatives by central differences of the fourth order, whose steps are halved until two agree:
// near a singular posture a function bends within a step that is short elsewhere.
#pragma once

#include <functional>

#include <Eigen/Core>

namespace stillbase::audit {

/// Values of functions at a distance along a line.
using AlongLine = std::function<Eigen::VectorXd(double)>;

/// First derivatives at zero. Of each function the estimate that differs least from the one at
/// twice its step: longer steps have larger errors, shorter ones more rounding.
/// @param step the longest; values are taken at twice that distance
Eigen::VectorXd slopes_at_zero(const AlongLine& values, double step);

/// Second derivatives at zero, likewise.
/// @param tolerance a difference of two estimates that is good enough
Eigen::VectorXd bends_at_zero(const AlongLine& values, double step, double tolerance);

}  // namespace stillbase::audit
