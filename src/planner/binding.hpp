// Limits that are reached at an optimum and decide its value.
#pragma once

#include <vector>

#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

/// The active inequalities at a minimum of the measure with their multipliers, the largest saving
/// per unit first.
///
/// With f = 1/2 |y|^2 / unit^2 of the measure and lambda its multiplier by non-negative least
/// squares on the first-order conditions (nlp::certify), the least f changes by -|lambda| per unit
/// that the limit gives way, and the reported value v = P(|y|) by P'(|y|) unit^2 / |y| times that.
/// Limits whose multiplier is below 1e-6 of the value per unit are not listed.
/// @param x variables of a point that satisfies the first-order conditions
/// @return nothing where the measure is zero but for rounding: no limit makes it smaller
std::vector<BindingLimit> binding_limits(const CaptureProblem& problem,
                                         const Formulation& formulation, const Eigen::VectorXd& x);

}  // namespace stillbase
