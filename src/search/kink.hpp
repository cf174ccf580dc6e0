// Minima at kinks of the constraints.
//
// A clearance is the least of many distances, smooth but where the closest feature changes. A
// minimum there has KKT residual zero only with the gradients of both sides, and one evaluation
// knows one of them. A local solver stops there with a large residual. To go on costs a hundred
// evaluations with their Hessians and seldom gains anything.
#pragma once

#include <stillbase/nlp/certificate.hpp>

namespace stillbase {

struct KinkOptions {
  double stationary = 1e-6;  ///< largest KKT residual
  int most_probes = 12;      ///< each adds a piece: as many as a minimum of so many variables needs
  /// Length of a probe: longer than the distance at which solvers stop before a kink, and so short
  /// that the error of the linear model, about its square, is far below 1e-6, within which a row
  /// counts as active.
  double probe = 1e-5;
  double other_slope = 1e-2;  ///< least difference of two pieces' slopes; rows are of order one
};

/// Whether the KKT residual at x vanishes, with the gradients on the other sides of its kinks.
/// These are looked for a short step along the remaining descent: while the linear model of the
/// constraints misses a violation there, the piece that is violated becomes a further row of the
/// model.
/// @param x feasible
bool is_stationary(const nlp::Problem& problem, const Eigen::VectorXd& x,
                   const KinkOptions& options = {});

}  // namespace stillbase
