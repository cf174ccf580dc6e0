// Of zeros of the objective that are not alone, the one nearest to the start posture.
//
// Where more variables are left than the zeros take, they fill a surface, and a solve ends where it
// happens to meet that. What the joints have to move tells them apart:
//
//   minimise  1/2 (x - x_s)' W (x - x_s)   subject to   y(x) = 0 and the constraints
//
// with x_s the start posture, joint angles counted to the nearest whole turn.
#pragma once

#include <optional>

#include <stillbase/formulation/formulation.hpp>
#include <stillbase/nlp/optimizer.hpp>

namespace stillbase {

struct NearestZeroOptions {
  /// W of the base's rotation and of the contact time, from the stated attitude and the middle of
  /// the time window; that of joints is one. It settles what the joints leave open.
  double other_weight = 1e-3;
  double dependent = 1e-6;    ///< part of a row that is no combination of those before it
  int max_evaluations = 200;  ///< 20 to 180; along a strongly bent surface the solver creeps
};

/// A local minimum of the distance, to its last digits; where the solver creeps, what it has come
/// to. That may break the constraints. Empty where the zero is alone or on a curve (continua.hpp).
/// @param zero of the nominal objective, on the constraints (N)
[[nodiscard]] std::optional<Eigen::VectorXd> nearest_zero(const CaptureProblem& problem,
                                                          const Formulation& formulation,
                                                          const Eigen::VectorXd& zero,
                                                          const nlp::Optimizer& optimizer,
                                                          nlp::OptimizeOptions solve,
                                                          const NearestZeroOptions& options = {});

}  // namespace stillbase
