// Of zeros of the objective that are not alone, one that is near the start posture.
//
// Where more variables are left than the zeros take, they fill a surface, and a solve ends where it
// happens to meet that. What the joints have to move tells them apart:
//
//   minimise  1/2 (x - x_s)' W (x - x_s) + 1/2 p sum_i m_i max(0, 1 - s_i / m_i)^2
//   subject to  y(x) = 0 and the constraints
//
// with x_s the start posture, angles counted to the nearest turn within the limits, and s_i the
// distances from bounds and inequalities: what lies on a limit is free of collisions, or within
// reach of a path, by rounding alone.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/formulation/formulation.hpp>

#include "search/solution.hpp"

namespace stillbase {

struct NearestZeroOptions {
  // W of joints is one. The others decide where the joints leave a choice: from the stated attitude
  // and the middle of the time window.
  double attitude_weight = 1e-3;
  double time_weight = 1e-2;      ///< over the square of half the window
  double push = 10;               ///< p: slope at the limit; that of the way is its length, rad
  double bound_margin = 0.05;     ///< m of bounds, rad (s); at most a twentieth of their range
  double row_margin = 0.01;       ///< m of inequalities, in their typical size
  double dependent = 1e-6;        ///< part of a row that is no combination of those before it
  int rough_solves = 4;           ///< each with its end put back onto the zeros
  int rough_evaluations = 60;     ///< of one of them
  double rough_violation = 1e-3;  ///< where it may end: on a bent surface the solver creeps if held
                                  ///< to less
  int evaluations = 100;          ///< of the last solve
  double stationary = 1e-7;       ///< KKT residual of a minimum, after refinement
  double singular = 1e-2;  ///< part of the slopes at the start: where surfaces cross, nothing
                           ///< holds a minimum in its place
};

/// A local minimum, to its last digits. Empty where the zero is alone or on a curve (continua.hpp),
/// and where the solves end at no minimum, or where slopes of y become dependent.
/// @param zero of the nominal objective, on the constraints (N)
[[nodiscard]] std::optional<Eigen::VectorXd> nearest_zero(const CaptureProblem& problem,
                                                          const Formulation& formulation,
                                                          const Eigen::VectorXd& zero,
                                                          const StopCondition& stop,
                                                          const NearestZeroOptions& options = {});

/// Moves the zeros that are nearest to the start posture nearer, unless they touch something there
/// and not here. The way of joints that zeros do not depend on does not count.
/// @param most at most so many of them
/// @param zero the largest |y| of a zero, typical sizes
/// @param is_free whether a configuration touches nothing; may be empty
/// @return false: the stop came first
bool move_zeros_nearer(const CaptureProblem& problem, const Formulation& formulation, int most,
                       double zero, const std::function<bool(const Configuration&)>& is_free,
                       const StopCondition& stop, int jobs, std::vector<Solution>& solutions);

}  // namespace stillbase
