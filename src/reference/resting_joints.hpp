// Joints at rest under Coulomb friction or at a stop: which of them begin to move, and where to.
#pragma once

#include <limits>
#include <vector>

#include <Eigen/Dense>

namespace stillbase::reference {

struct RestingJoint {
  int joint = 0;
  double friction = 0;  ///< N m (N)
  /// Bounds of its acceleration: 0 below at a lower stop, 0 above at an upper one.
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
};

/// Signs of the accelerations of joints at rest: -1, 0 (stays at rest) or 1, one per joint.
///
/// By Gauss's principle the accelerations a minimise a' H a / 2 - load' a + sum_k friction_k |a_k|
/// within the bounds. The base and the moving joints are eliminated; what is left is minimised one
/// joint after the other, which ends at the one minimum there is.
/// @param H (6+n) x (6+n), order [Omega; phidot]
/// @param load 6+n: all forces but those of friction and stops of `joints`, less the bias
std::vector<int> starting_directions(const Eigen::MatrixXd& H, const Eigen::VectorXd& load,
                                     const std::vector<RestingJoint>& joints);

}  // namespace stillbase::reference
