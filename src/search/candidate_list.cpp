#include "search/candidate_list.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/parallel.hpp>

#include "search/ranking.hpp"

namespace stillbase {

namespace {

/// The measure's value, from nominal value and worst case where these are the measure. The nominal
/// value where the mean over samples is not known.
double reported(Measure& measure, const Eigen::VectorXd& x, double nominal, double worst) {
  if (measure.is_nominal()) return nominal;
  if (measure.kind() == RiskMeasure::WorstCase) return worst;
  const double value = measure.reported(x);
  return std::isnan(value) ? nominal : value;
}

/// All that is known of a solution but its certificate.
Candidate candidate_of(const CaptureProblem& problem, const Formulation& formulation,
                       Measure& measure, const Solution& solution, const WorstCase& worst) {
  Candidate out;
  out.configuration = formulation.configuration(solution.x);
  out.objective = nominal_value(problem, formulation, out.configuration);
  out.worst_case = worst.value;
  out.max_violation = solution.violation;
  out.starts_reached = solution.reached;
  out.family = solution.family;
  out.value = reported(measure, solution.x, out.objective, out.worst_case);
  out.is_judged = measure.knows(solution.x);
  return out;
}

}  // namespace

std::optional<NominalOptimum> nominal_optimum(const CaptureProblem& problem,
                                              const Formulation& formulation, Measure& measure,
                                              const std::vector<Solution>& solutions,
                                              double equal) {
  double lowest = kInfinity;
  for (const Solution& solution : solutions) lowest = std::min(lowest, solution.length());
  std::vector<Candidate> best;
  for (const Solution& solution : solutions) {
    if (solution.length() > lowest + equal) continue;
    const WorstCase worst = measure.worst_at(solution.x);
    const double measured = measure.value(solution.x);
    if (!measure.knows(solution.x) || std::isnan(measured)) return std::nullopt;
    best.push_back(candidate_of(problem, formulation, measure, solution, worst));
  }
  if (best.empty()) return std::nullopt;
  const Candidate& first = best[candidate_order(problem, best, equal * formulation.objective_unit(),
                                                RiskMeasure::Nominal)
                                    .front()];
  return NominalOptimum{first.configuration, first.objective, first.worst_case, first.value};
}

void list_candidates(const CaptureProblem& problem, const Formulation& formulation,
                     Measure& measure, const std::vector<Solution>& solutions,
                     const SearchOptions& options, int jobs, SearchResult& out) {
  // Side by side what the list below asks for one by one.
  for_each_index(jobs, static_cast<int>(solutions.size()), {}, [&](int i) {
    const Eigen::VectorXd& x = solutions[static_cast<std::size_t>(i)].x;
    static_cast<void>(measure.worst_at(x));
    if (!measure.is_nominal()) static_cast<void>(measure.value(x));
  });
  std::vector<Candidate> candidates;
  std::vector<WorstCase> worst;
  for (const Solution& solution : solutions) {
    worst.push_back(measure.worst_at(solution.x));
    candidates.push_back(candidate_of(problem, formulation, measure, solution, worst.back()));
  }
  std::vector<std::size_t> order =
      candidate_order(problem, candidates, options.equal_nominal * formulation.objective_unit());
  const auto most = static_cast<std::size_t>(options.max_candidates);
  order.resize(std::min(order.size(), most));
  std::vector<nlp::Certificate> residuals(order.size());
  for_each_index(jobs, static_cast<int>(order.size()), {}, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    residuals[k] = measure.certify(solutions[order[k]].x);
  });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::size_t i = order[k];
    Certificate certificate;
    certificate.kkt_residual = residuals[k].kkt_residual;
    certificate.reduced_hessian_min_eigenvalue = residuals[k].reduced_hessian_min_eigenvalue;
    certificate.max_violation = candidates[i].max_violation;
    certificate.starts = out.starts;
    certificate.distinct_solutions = out.distinct_solutions;
    certificate.unseen = out.unseen;
    certificate.had_rounds = out.had_rounds;
    out.candidates.push_back(candidates[i]);
    out.certificates.push_back(certificate);
    out.worst_cases.push_back(worst[i]);
    out.points.push_back(solutions[i].x);
  }
}

PlanStatus status_of(const Certificate& certificate) {
  if (!(certificate.max_violation <= kFeasibilityTolerance)) return PlanStatus::Infeasible;
  return certificate.kkt_residual <= kOptimal ? PlanStatus::Optimal : PlanStatus::Feasible;
}

}  // namespace stillbase
