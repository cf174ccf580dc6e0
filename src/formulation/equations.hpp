// The equations of a formulation, without its inequalities: hand, case, and zeros of the objective.
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

}  // namespace stillbase
