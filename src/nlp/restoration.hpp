// Newton steps onto equations and back onto the constraints.
#pragma once

#include "nlp/monitor.hpp"

namespace stillbase::nlp {

/// The shortest d with J d = r, in the least squares where no d has that. Rows whose part beside
/// those before is below 1e-9 of the longest count as dependent.
Eigen::VectorXd shortest_step(const Eigen::MatrixXd& J, Eigen::VectorXd r);

/// Step of least norm with J step = -r that keeps inside the box to first order: variables at a
/// bound that it would cross are held.
Eigen::VectorXd step_within_box(Eigen::MatrixXd J, const Eigen::VectorXd& r,
                                const Eigen::VectorXd& x, const Eigen::VectorXd& lower,
                                const Eigen::VectorXd& upper);

/// Moves x onto the violated constraints by Gauss-Newton steps of least length inside the box
/// (variables at a bound that the step would cross are held), each halved until the violation
/// falls. Ends at a violation of at most `tolerance`, when nothing falls any more, or when the
/// monitor stops. x must lie in the box.
/// @param g_lower, g_upper range of the constraints (m), the problem's or a narrower one
/// @param at_x in: the evaluation at x; out: at the moved x
/// @return largest violation of a constraint at the moved x
double restore(Monitor& monitor, const Eigen::VectorXd& g_lower, const Eigen::VectorXd& g_upper,
               double tolerance, int max_steps, Eigen::VectorXd& x, Evaluation& at_x);

}  // namespace stillbase::nlp
