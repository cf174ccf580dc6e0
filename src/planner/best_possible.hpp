// The bound beside the search: how much better could any posture be than the best candidate?
#pragma once

#include <stillbase/capture/search.hpp>

namespace stillbase {

/// Adds to a proof a lower bound of the problem's measure over all postures and the gap of the best
/// candidate to it, where that says something.
///
/// Nothing is added where the measure is zero at the best candidate (no less is possible), where
/// the bound is zero, or for problems that minimum_objection() is about. A problem whose solutions
/// could not be enclosed keeps its status: the bound alone is proven.
void add_bound(const CaptureProblem& problem, const Formulation& formulation,
               const SearchResult& found, const StopCondition& stop, Proof& proof);

}  // namespace stillbase
