// What a search states of its solutions: candidates in their order, with certificates.
#pragma once

#include <optional>
#include <vector>

#include <stillbase/search/search.hpp>

#include "formulation/measures/measure.hpp"
#include "search/solution.hpp"

namespace stillbase {

/// The best posture by the nominal value alone; see NominalOptimum. Empty when a limit came first.
std::optional<NominalOptimum> nominal_optimum(const CaptureProblem& problem,
                                              const Formulation& formulation, Measure& measure,
                                              const std::vector<Solution>& solutions, double equal);

/// Writes candidates, certificates, worst cases and points of the best `options.max_candidates`
/// solutions into `out`, whose counts and estimates the certificates repeat. @param jobs threads
void list_candidates(const CaptureProblem& problem, const Formulation& formulation,
                     Measure& measure, const std::vector<Solution>& solutions,
                     const SearchOptions& options, int jobs, SearchResult& out);

}  // namespace stillbase
