// The order in which candidates are listed, tried and cut off.
#pragma once

#include <vector>

#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// Indices of the candidates, best first: by the value of the measure. Of the nominal measure,
/// candidates within `equal` of the least nominal value of those that remain count as equal; they
/// follow each other by their worst case.
/// @param equal difference of objective lengths |y| (Power::length), in the objective's unit
std::vector<std::size_t> candidate_order(const CaptureProblem& problem,
                                         const std::vector<Candidate>& candidates, double equal);

}  // namespace stillbase
