// A search for the solutions of a small problem, apart from the planner's and from its proof:
// Gauss-Newton by `reference` from evenly spread starts.
#pragma once

#include <string>
#include <vector>

#include "audit/checks.hpp"

namespace stillbase::audit {

struct Recount {
  std::string not_done;  ///< why the problem is not small enough; empty: it is
  /// The equations leave freedom, so the objective's zeros were searched.
  bool asks_for_zero = false;
  std::vector<Configuration> solutions;  ///< distinct; base position as stated
  int starts = 0;
};

/// Isolated configurations within the bounds that satisfy the hand's equations, the wanted case and
/// the inequalities, among them limits on rates, singular values and clearances. Where the
/// equations leave freedom, the objective is zero as well. For problems with one to three variables
/// among joints, base angle about an axis and time.
Recount search_solutions(const Context& context);

/// Whether a configuration is on a self-motion curve of zeros of the nominal objective: the
/// equations leave freedom, and together with the zero one direction. True only where this is
/// certain, and only for objectives of one angular quantity.
bool is_on_curve_of_zeros(const CaptureProblem& problem, const Configuration& at);

}  // namespace stillbase::audit
