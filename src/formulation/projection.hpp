// Newton-like moves onto the constraints, and onto zeros of the objective.
#pragma once

#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

struct ProjectionResult {
  Eigen::VectorXd x;
  double violation = kInfinity;  ///< largest, of constraints and bounds
};

/// Gauss-Newton with minimum-norm steps from x onto the constraints, inside the bounds.
/// @param zero_objective also drive the objective vector y to zero
ProjectionResult project_onto_constraints(const Formulation& formulation, const Eigen::VectorXd& x,
                                          bool zero_objective, int max_iterations);

}  // namespace stillbase
