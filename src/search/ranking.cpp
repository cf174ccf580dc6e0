#include "search/ranking.hpp"

#include <algorithm>
#include <numeric>

#include <stillbase/plan/scenario.hpp>

namespace stillbase {

std::vector<std::size_t> candidate_order(const CaptureProblem& problem,
                                         const std::vector<Candidate>& candidates, double equal) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto sort = [&](auto begin, auto end, double Candidate::*by) {
    std::stable_sort(begin, end, [&](std::size_t a, std::size_t b) {
      return candidates[a].*by < candidates[b].*by;
    });
  };
  if (problem.measure.kind != RiskMeasure::Nominal) {
    sort(order.begin(), order.end(), &Candidate::value);
    return order;
  }
  sort(order.begin(), order.end(), &Candidate::objective);
  const Power power = objective_power(problem);
  for (auto begin = order.begin(); begin != order.end();) {
    const double most = power.length(candidates[*begin].objective) + equal;
    const auto end = std::find_if(begin, order.end(), [&](std::size_t i) {
      return !(power.length(candidates[i].objective) <= most);
    });
    if (end == begin) break;  // not a number: sorted last
    sort(begin, end, &Candidate::worst_case);
    begin = end;
  }
  return order;
}

}  // namespace stillbase
