// A search for the solutions of a small problem, apart from the planner's and from its proof:
// Newton by `reference` from evenly spread starts.
#pragma once

#include <string>
#include <vector>

#include "verification/checks.hpp"

namespace stillbase::verification {

struct Recount {
  std::string not_done;                    ///< why the problem is none of those; empty: it is
  std::vector<Eigen::VectorXd> solutions;  ///< phi (n), distinct
  int starts = 0;
};

/// Postures within the joint limits that meet the hand's point and the wanted case and, where these
/// equations leave freedom, make the objective zero; isolated ones. For problems with one to three
/// free joints and everything else fixed.
/// @param event at the stated base pose and contact time
Recount search_solutions(const Context& context, const ContactEvent& event);

}  // namespace stillbase::verification
