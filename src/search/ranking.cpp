#include "search/ranking.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <stillbase/plan/scenario.hpp>
#include <stillbase/plan/turns.hpp>

namespace stillbase {

namespace {

using Indices = std::vector<std::size_t>;
using Key = double Candidate::*;

class Order {
 public:
  Order(const CaptureProblem& problem, const std::vector<Candidate>& candidates, double equal,
        RiskMeasure measure)
      : candidates_(candidates), power_(objective_power(problem)), equal_(equal) {
    if (measure == RiskMeasure::Nominal) {
      keys_ = {&Candidate::objective, &Candidate::worst_case};
    } else {
      keys_ = {&Candidate::value};
    }
    for (const Candidate& candidate : candidates) {
      std::vector<double> place{least_way_from_start(problem, candidate.configuration)};
      for (const double angle : candidate.configuration.phi) place.push_back(angle);
      for (double& number : place) number = std::round(number / kSamePlace);
      places_.push_back(std::move(place));
    }
  }

  void sort(Indices::iterator begin, Indices::iterator end, std::size_t key = 0) const {
    if (end - begin < 2) return;
    if (key == keys_.size()) {
      std::stable_sort(begin, end,
                       [&](std::size_t a, std::size_t b) { return places_[a] < places_[b]; });
      return;
    }
    const auto value = [&](std::size_t i) {
      const double number = candidates_[i].*keys_[key];
      return std::isnan(number) ? kInfinity : number;
    };
    std::stable_sort(begin, end, [&](std::size_t a, std::size_t b) { return value(a) < value(b); });
    while (begin != end) {
      const double most = power_.length(value(*begin)) + equal_;
      const auto next =
          std::find_if(begin, end, [&](std::size_t i) { return power_.length(value(i)) > most; });
      sort(begin, next, key + 1);
      begin = next;
    }
  }

 private:
  static constexpr double kSamePlace = 1e-6;  ///< rad (m): less is rounding of a local solve

  const std::vector<Candidate>& candidates_;
  Power power_;
  double equal_;
  std::vector<Key> keys_;
  std::vector<std::vector<double>> places_;  ///< way from the start posture, then the joints
};

}  // namespace

std::vector<std::size_t> candidate_order(const CaptureProblem& problem,
                                         const std::vector<Candidate>& candidates, double equal) {
  return candidate_order(problem, candidates, equal, problem.measure.kind);
}

std::vector<std::size_t> candidate_order(const CaptureProblem& problem,
                                         const std::vector<Candidate>& candidates, double equal,
                                         RiskMeasure measure) {
  Indices order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  Order(problem, candidates, equal, measure).sort(order.begin(), order.end());
  return order;
}

}  // namespace stillbase
