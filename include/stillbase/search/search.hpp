// The search over configurations: many starts, local solves, distinct solutions, ranking.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/formulation/measures/robust.hpp>

namespace stillbase {

struct SearchOptions {
  std::string optimizer = "nlopt-slsqp";
  int starts = 64;
  std::uint64_t seed = 1;
  int max_candidates = 32;
  std::vector<Eigen::VectorXd> more_starts;  ///< points to start from as well (N each)
  /// Whether a configuration touches nothing; may be empty. Where solutions form a curve, the best
  /// of those that touch nothing are listed as well.
  std::function<bool(const Configuration&)> is_free;
  /// Called after every start with (done, total); may be empty.
  std::function<void(int, int)> on_progress;
  StopCondition stop;
};

struct SearchResult {
  PlanStatus status = PlanStatus::Infeasible;
  /// Distinct local minima of the problem's measure and of the nominal value that satisfy all
  /// constraints, ranked by the measure (the nominal one: by their worst case); when there is none,
  /// the single least violated point. Where the zeros of the nominal value form a curve: the local
  /// minima of the worst case along it.
  std::vector<Candidate> candidates;
  std::vector<Certificate> certificates;  ///< one per candidate
  std::vector<WorstCase> worst_cases;     ///< one per candidate
  std::vector<SolutionFamily> families;   ///< curves of zeros of the nominal value
  /// The best by the nominal value alone.
  std::optional<NominalOptimum> nominal_optimum;
  std::vector<Eigen::VectorXd> points;  ///< variables of each candidate
  int starts = 0;                       ///< done
  int distinct_solutions = 0;           ///< before the list was cut
  /// Estimated probability that one more start ends at a solution of the nominal problem that none
  /// has reached: the share of the starts whose solution, or curve of solutions, was reached once
  /// (Good and Turing). Near 1 where more than one direction is open at the solutions.
  double unseen = 1;
  bool stopped = false;  ///< a limit or an interrupt came before the end
  std::map<std::string, long> solver_calls;
  long evaluations = 0;
};

/// Optimal: violation at most 1e-9 and KKT residual at most 1e-6; feasible: the first only.
PlanStatus status_of(const Certificate& certificate);

/// Where the objective is simulated and the formulation gives simulations up at the same stop, what
/// is left to do after it takes a few of them: the best solution whose measure is known is
/// returned, or the best by the nominal value, with is_judged false and no certificate.
///
/// @throws std::invalid_argument for an optimizer that is not in the registry
SearchResult search(const CaptureProblem& problem, const Formulation& formulation,
                    const SearchOptions& options);

}  // namespace stillbase
