// A local minimum to its last digits.
//
// Local solvers end where the gradient is small. Where the objective is flat that leaves the place
// open: a residual of 1e-9 at a curvature of 1e-2 is 1e-7 in x, and another compiler or another
// instruction set ends elsewhere. Newton's method on the KKT conditions
//
//   grad f + A' u = 0,   c = 0      (c, A: the active rows and bounds, their gradients)
//
// converges quadratically to what only the rounding of the gradient leaves open. Where a direction
// is open, as the turn about an axis of symmetry, x is rounded along it. Source: Nocedal
// and Wright, Numerical Optimization, 2nd ed., 2006, section 16.2 (null-space method).
#pragma once

#include <stillbase/nlp/problem.hpp>

namespace stillbase::nlp {

struct RefinementOptions {
  double near = 1e-5;    ///< KKT residual from which it begins: farther off the active rows are not
                         ///< those of the minimum
  double active = 1e-6;  ///< as CertificateOptions::activity_tolerance
  double longest_step = 1e-3;         ///< in any variable; solvers that ended are nearer
  double flat = 1e-10;                ///< of the norm of the Hessian: less curvature is rounding
  double flat_by_differences = 1e-8;  ///< the same by differences, at least of 1
  double bend = 100;                  ///< of the remaining slope: curvature that it may be alone
  double grid = 1e-5;                 ///< onto which x is rounded along flat directions
  double difference = 1e-6;           ///< step in x where the problem has no Hessian
  double other_slope = 1e-2;   ///< least difference of the slopes at a kink; rows are of order one
  double beyond_kink = 1e-13;  ///< violation of a row that keeps the side of its kink
  int most_steps = 8;
  // What the refined point may have, if x has less.
  double feasible = 1e-12;    ///< violation
  double stationary = 1e-11;  ///< KKT residual
};

/// The minimum that x is near, or x where it is near none: at a KKT residual beyond `near`, at a
/// saddle, and where the first step is too long. Along directions in which nothing changes x
/// decides, but for digits beyond `grid`. A problem without a Hessian has it from differences of
/// its gradients.
/// @param x inside the bounds, from a local solver (N)
[[nodiscard]] Eigen::VectorXd refined_minimum(const Problem& problem, const Eigen::VectorXd& x,
                                              const RefinementOptions& options = {});

}  // namespace stillbase::nlp
