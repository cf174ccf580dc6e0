// The bound beside the search: how much better could any posture be than the best candidate?
#pragma once

#include <optional>

#include <stillbase/plan/prover.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/search/search.hpp>

namespace stillbase {

/// The least value of the measure among the candidates that satisfy the constraints; empty: none
/// does.
std::optional<double> best_value(const SearchResult& found);

/// Whether it is zero but for rounding: no less is possible.
bool is_zero_reached(const Formulation& formulation, const SearchResult& found);

/// A lower bound of the problem's measure over all configurations.
/// @param prover null: there is none
/// @param enclosed the proof so far
/// @return empty where the prover has an objection to the problem, or where is_zero_reached()
std::optional<MinimumBound> bound_measure(const Prover* prover, const CaptureProblem& problem,
                                          const Formulation& formulation, const SearchResult& found,
                                          const Proof& enclosed, MinimumOptions options,
                                          const BoundOptions& bound = {});

/// Adds it to a proof, where it says something. A problem whose solutions could not be enclosed
/// keeps its status: the bound alone is proven.
void state_bound(const MinimumBound& bound, Proof& proof);

}  // namespace stillbase
