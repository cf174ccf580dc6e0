// The equations of a formulation (hand, case, zeros of the objective), and Newton-like moves onto
// them and the other constraints.
#pragma once

#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

/// Residual and Jacobian (rows x N) of the equality constraints at x, in their own units.
/// @param with_zero also those of the objective vector y, in typical sizes
void evaluate_equations(const Formulation& formulation, const Eigen::VectorXd& x, bool with_zero,
                        Eigen::VectorXd& residual, Eigen::MatrixXd& jacobian);

/// Orthonormal basis (columns) of the directions in which none of them changes: the null space of
/// that Jacobian, singular values below 1e-9 of the largest counted as zero.
Eigen::MatrixXd open_directions(const Formulation& formulation, const Eigen::VectorXd& x,
                                bool with_zero);

/// The same configuration with a rotation angle of the base of at most pi. Bounds of the variables
/// of an attitude without a limit are none of the configuration: what ends at them may go on here.
/// @param other_turn far more than rounding, less than between two rotation vectors of one rotation
Eigen::VectorXd in_shortest_turns(const Formulation& formulation, const Eigen::VectorXd& x,
                                  double other_turn = 1);

/// The end of a local solve in shortest turns. A solve that ends in longer ones is made again from
/// there.
/// @param solve the point at which a solve from a given one ends
template <class Solve>
Eigen::VectorXd solved_in_shortest_turns(const Formulation& formulation, const Eigen::VectorXd& x0,
                                         const Solve& solve) {
  const Eigen::VectorXd x = solve(x0);
  const Eigen::VectorXd shortest = in_shortest_turns(formulation, x);
  return shortest == x ? x : in_shortest_turns(formulation, solve(shortest));
}

struct ProjectionOptions {
  double longest_step = 0.5;  ///< rad: beyond it the linear model does not hold
  double exact = 1e-14;       ///< largest residual that ends the steps: the rounding of rows
  /// The same where zeros of a simulated objective are wanted: simulations have larger rounding
  /// errors and cost too much for the last digits.
  double exact_simulated = 1e-11;
  int halvings = 12;  ///< of a step that does not lower the residual; 1/4096 of it is lost anyway
  /// Of the squared residual: a step that takes off less is slow.
  double least_fall = 0.01;
  int slow_steps = 3;  ///< in a row are the last: it stays where the constraints are out of reach
};

struct ProjectionResult {
  Eigen::VectorXd x;
  double violation = kInfinity;  ///< largest, of constraints and bounds
};

/// Gauss-Newton with minimum-norm steps from x onto the constraints, inside the bounds.
/// @param zero_objective also drive the objective vector y to zero
ProjectionResult project_onto_constraints(const Formulation& formulation, const Eigen::VectorXd& x,
                                          bool zero_objective, int max_iterations,
                                          const ProjectionOptions& options = {});

}  // namespace stillbase
