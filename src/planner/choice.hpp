// Where the chosen configuration stands among the candidates.
#pragma once

#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// The same bits.
bool is_same_configuration(const Configuration& a, const Configuration& b);

/// Counts the candidates that rank before the chosen one, keeps `excluded` for them alone (those
/// without a reason were not tried), and states what the choice costs. A plan that is Optimal
/// becomes Feasible when a candidate has a smaller measure.
/// @param equal values of the measure that differ by less are equal, in its unit
/// @param improvement the same, relative
void state_choice(Plan& plan, double equal, double improvement);

}  // namespace stillbase
