// The order in which candidates are listed, tried and cut off.
#pragma once

#include <vector>

#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// Indices of the candidates, best first: by the value of the measure; of the nominal measure by
/// the nominal value, then by the worst case. Candidates within `equal` of the least value of those
/// that remain count as equal, as zeros that differ by rounding: the nearer to the start posture
/// goes first (least_way_from_start()), of equally near ones that of the lesser first joint.
/// @param equal difference of objective lengths |y| (Power::length), in the objective's unit
std::vector<std::size_t> candidate_order(const CaptureProblem& problem,
                                         const std::vector<Candidate>& candidates, double equal);

/// The same by another measure than the problem's.
std::vector<std::size_t> candidate_order(const CaptureProblem& problem,
                                         const std::vector<Candidate>& candidates, double equal,
                                         RiskMeasure measure);

}  // namespace stillbase
