// The proof beside the search: are all solutions among the candidates?
#pragma once

#include <vector>

#include <stillbase/plan/prover.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/search/search.hpp>

namespace stillbase {

/// The proof of a problem, or why there is none.
/// @param prover null: there is none
Proof prove_solutions(const Prover* prover, const CaptureProblem& problem,
                      const Formulation& formulation, const StopCondition& stop,
                      const EnclosureOptions& enclosure = {});

/// Fills in which candidate lies in which enclosed solution.
void match_candidates(const CaptureProblem& problem, const SearchResult& found, Proof& proof,
                      const EnclosureOptions& options = {});

/// Whether an enclosed solution has no candidate.
bool has_missing_solutions(const Proof& proof);

/// Middles of the enclosed solutions, as points of the formulation.
std::vector<Eigen::VectorXd> enclosed_points(const CaptureProblem& problem, const Proof& proof);

/// Adds to the statement what the search had missed, if anything.
void state_what_was_missed(Proof& proof);

}  // namespace stillbase
