// The search over configurations: many starts, local solves, distinct solutions, ranking.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <stillbase/capture/formulation.hpp>
#include <stillbase/core/interrupt.hpp>

namespace stillbase {

struct SearchOptions {
  std::string optimizer = "nlopt-slsqp";
  int starts = 64;
  std::uint64_t seed = 1;
  int max_candidates = 32;
  /// Called after every start with (done, total); may be empty.
  std::function<void(int, int)> on_progress;
  StopCondition stop;
};

struct SearchResult {
  PlanStatus status = PlanStatus::Infeasible;
  /// Distinct solutions that satisfy all constraints, best worst case first; when there is none,
  /// the single least violated point.
  std::vector<Candidate> candidates;
  std::vector<Certificate> certificates;  ///< one per candidate
  int starts = 0;                         ///< done
  int distinct_solutions = 0;             ///< before the list was cut
  bool stopped = false;                   ///< a limit or an interrupt ended the search
  std::map<std::string, long> solver_calls;
  long evaluations = 0;
};

SearchResult search(const CaptureProblem& problem, const Formulation& formulation,
                    const SearchOptions& options);

}  // namespace stillbase
