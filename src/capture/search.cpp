#include <stillbase/capture/search.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <stillbase/capture/robust.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "capture/measure_search.hpp"
#include "capture/projection.hpp"
#include "capture/screening.hpp"

namespace stillbase {

namespace {

constexpr double kFeasible = 1e-9;  ///< largest violation of a feasible plan
constexpr double kOptimal = 1e-6;   ///< largest KKT residual of an optimal plan
constexpr double kSameConfiguration = 1e-5;
constexpr int kMoreDraws = 8;       ///< of a start point that the constraints refuse
constexpr int kDrawn = 256;         ///< more postures for the measure, of which the best are kept:
constexpr int kKept = 16;           ///< they count where few starts are asked for
constexpr double kSameStart = 0.1;  ///< rad between two of them
constexpr double kOnConstraints = 1e-3;  ///< violation from which a local solver can go on

struct Solution {
  Eigen::VectorXd x;
  double objective = kInfinity;  ///< nominal, or the measure's; 1/2 |y|^2 in objective units
  double violation = kInfinity;
  int reached = 1;
};

double largest_violation(const Formulation& formulation, const Eigen::VectorXd& x) {
  double worst = 0;
  for (const ConstraintValue& value : formulation.report(x)) {
    worst = std::max(worst, value.violation);
  }
  return worst;
}

Solution judge(const Formulation& formulation, const Eigen::VectorXd& x) {
  nlp::Evaluation at_x;
  formulation.evaluate_value(x, at_x);
  return {x, at_x.objective, largest_violation(formulation, x), 1};
}

/// The better of two points: feasible before infeasible, then the lower objective.
bool better(const Solution& a, const Solution& b) {
  const bool fa = a.violation <= kFeasible, fb = b.violation <= kFeasible;
  if (fa != fb) return fa;
  return fa ? a.objective < b.objective : a.violation < b.violation;
}

/// What a local solver leaves is close; Newton steps make constraints exact and zeros exact.
Solution polish(const Formulation& formulation, const Solution& found) {
  Solution best = found;
  const auto consider = [&](const ProjectionResult& moved) {
    const Solution trial = judge(formulation, moved.x);
    if (better(trial, best) && formulation.distance(trial.x, found.x) < 0.1) best = trial;
  };
  consider(project_onto_constraints(formulation, best.x, false, 8));
  if (best.objective < 1e-6 && best.objective > 0) {
    consider(project_onto_constraints(formulation, best.x, true, 20));
  }
  return best;
}

void keep_distinct(const Formulation& formulation, const Solution& found,
                   std::vector<Solution>& solutions) {
  for (Solution& known : solutions) {
    if (formulation.distance(known.x, found.x) > kSameConfiguration) continue;
    const int reached = known.reached + found.reached;
    if (better(found, known)) known = found;
    known.reached = reached;
    return;
  }
  solutions.push_back(found);
}

/// The measure's value; nominal value and worst case are known already, to the last bit.
double reported(const Measure& measure, const Eigen::VectorXd& x, double nominal, double worst) {
  switch (measure.kind()) {
    case RiskMeasure::Nominal:
      return nominal;
    case RiskMeasure::WorstCase:
      return worst;
    default:
      return measure.reported(x);
  }
}

/// What the prediction alone would have chosen; see NominalOptimum.
NominalOptimum nominal_optimum(const CaptureProblem& problem, const Formulation& formulation,
                               const Measure& measure, const std::vector<Solution>& solutions) {
  const auto size = [](const Solution& solution) { return std::sqrt(2 * solution.objective); };
  double lowest = kInfinity;
  for (const Solution& solution : solutions) lowest = std::min(lowest, size(solution));
  constexpr double kEqual = 1e-8;  // of the objective's typical size
  NominalOptimum best;
  best.worst_case = kInfinity;
  for (const Solution& solution : solutions) {
    if (size(solution) > lowest + kEqual) continue;
    const Configuration configuration = formulation.configuration(solution.x);
    const double worst = worst_case(problem, formulation, configuration).value;
    if (worst >= best.worst_case) continue;
    const double nominal = nominal_value(problem, formulation, configuration);
    best = {configuration, nominal, worst, reported(measure, solution.x, nominal, worst)};
  }
  return best;
}

/// Postures on the constraints that look best for the measure, out of many draws.
std::vector<Eigen::VectorXd> screened_starts(const CaptureProblem& problem,
                                             const Formulation& formulation,
                                             const SearchOptions& options, int first_draw) {
  std::vector<Eigen::VectorXd> drawn;
  for (int draw = first_draw; draw < first_draw + kDrawn && !options.stop.reached(); ++draw) {
    const Eigen::VectorXd x0 = formulation.start_point(
        low_discrepancy_point(draw, formulation.start_dimension(), options.seed));
    const ProjectionResult projected = project_onto_constraints(formulation, x0, false, 15);
    if (projected.violation <= kOnConstraints) drawn.push_back(projected.x);
  }
  return best_by_screening(problem, formulation, drawn, kKept, kSameStart);
}

}  // namespace

SearchResult search(const CaptureProblem& problem, const Formulation& formulation,
                    const SearchOptions& options) {
  const auto optimizer = nlp::make_optimizer(options.optimizer);
  if (!optimizer) throw std::invalid_argument("no optimizer named " + options.optimizer);
  nlp::OptimizeOptions optimize;
  optimize.max_evaluations = 1000;  // a local solve needs about 40; creeping is cut off
  optimize.stop = options.stop;
  optimize.feasibility_tolerance = kFeasible;
  optimize.optimality_tolerance = kOptimal;

  SearchResult out;
  std::vector<Solution> solutions;
  Solution nearest;
  // With as many equations as variables the solutions are isolated points and there is nothing to
  // minimise: Newton steps from many more starts find them, and cost less than one local solve.
  const bool isolated = formulation.freedom() == 0;
  const Measure measure(problem, formulation);
  std::vector<Eigen::VectorXd> projected_starts;
  const int own_starts = isolated ? 16 * options.starts : options.starts;
  const int starts = own_starts + static_cast<int>(options.more_starts.size());
  for (int start = 0; start < starts; ++start) {
    if (options.stop.reached() && start > 0) {
      out.stopped = true;
      break;
    }
    const Eigen::VectorXd x0 =
        start < own_starts ? formulation.start_point(low_discrepancy_point(
                                 start, formulation.start_dimension(), options.seed))
                           : options.more_starts[static_cast<std::size_t>(start - own_starts)];
    ProjectionResult projected =
        project_onto_constraints(formulation, x0, false, isolated ? 60 : 15);
    // Many random postures lead nowhere: another one costs far less than a solve from there.
    const bool may_draw = start < own_starts && !isolated;
    for (int again = 1; again <= kMoreDraws && may_draw && projected.violation > kOnConstraints;
         ++again) {
      const Eigen::VectorXd other = formulation.start_point(low_discrepancy_point(
          start + again * own_starts, formulation.start_dimension(), options.seed));
      const ProjectionResult trial = project_onto_constraints(formulation, other, false, 15);
      if (trial.violation < projected.violation) projected = trial;
    }
    if (projected.violation <= kOnConstraints) projected_starts.push_back(projected.x);
    Solution found;
    if (isolated && start >= options.starts) {
      found = judge(formulation, formulation.normalised(projected.x));
    } else {
      optimize.seed = options.seed + static_cast<std::uint64_t>(start);
      const nlp::OptimizeResult result = optimizer->minimize(formulation, projected.x, optimize);
      ++out.solver_calls[options.optimizer];
      found = polish(formulation, judge(formulation, formulation.normalised(result.x)));
    }
    found.x = formulation.normalised(found.x);
    ++out.starts;
    if (better(found, nearest)) nearest = found;
    if (found.violation <= kFeasible) keep_distinct(formulation, found, solutions);
    if (options.on_progress) options.on_progress(start + 1, starts);
  }

  if (solutions.empty() && nearest.x.size() > 0) solutions.push_back(nearest);
  out.distinct_solutions = nearest.violation <= kFeasible ? static_cast<int>(solutions.size()) : 0;
  if (out.distinct_solutions > 0) {
    out.nominal_optimum = nominal_optimum(problem, formulation, measure, solutions);
    if (!measure.is_nominal() && !isolated) {
      std::vector<Eigen::VectorXd> from = std::move(projected_starts);
      for (const Solution& solution : solutions) from.push_back(solution.x);
      const int used = own_starts * (1 + kMoreDraws);
      for (Eigen::VectorXd& start : screened_starts(problem, formulation, options, used)) {
        from.push_back(std::move(start));
      }
      // A long list is asked for where much of it may touch something.
      MeasureSearchOptions effort;
      effort.finished = std::max(effort.finished, options.max_candidates / 4);
      const MeasureMinima found =
          measure_minima(formulation, measure, *optimizer, optimize, from, effort);
      out.solver_calls[options.optimizer] += found.solver_calls;
      out.stopped = out.stopped || found.stopped;
      std::vector<Solution> minima;
      for (const Eigen::VectorXd& x : found.points) {
        keep_distinct(formulation, {x, measure.value(x), largest_violation(formulation, x), 1},
                      minima);
      }
      // What the prediction alone would choose stays in the list: another choice when the minima
      // of the measure touch something.
      for (Solution& solution : solutions) {
        solution.objective = measure.value(solution.x);
        keep_distinct(formulation, solution, minima);
      }
      solutions = std::move(minima);
      out.distinct_solutions = static_cast<int>(solutions.size());
    }
  }
  std::vector<std::pair<Candidate, Eigen::VectorXd>> ranked;
  for (const Solution& solution : solutions) {
    Candidate candidate;
    candidate.configuration = formulation.configuration(solution.x);
    candidate.objective = nominal_value(problem, formulation, candidate.configuration);
    candidate.worst_case = worst_case(problem, formulation, candidate.configuration).value;
    candidate.max_violation = solution.violation;
    candidate.starts_reached = solution.reached;
    candidate.value = reported(measure, solution.x, candidate.objective, candidate.worst_case);
    ranked.emplace_back(candidate, solution.x);
  }
  std::stable_sort(ranked.begin(), ranked.end(), [&measure](const auto& a, const auto& b) {
    return measure.is_nominal() ? a.first.worst_case < b.first.worst_case
                                : a.first.value < b.first.value;
  });
  if (static_cast<int>(ranked.size()) > options.max_candidates) {
    ranked.resize(static_cast<std::size_t>(options.max_candidates));
  }
  for (const auto& [candidate, x] : ranked) {
    const nlp::Certificate kkt = measure.certify(x);
    Certificate certificate;
    certificate.kkt_residual = kkt.kkt_residual;
    certificate.reduced_hessian_min_eigenvalue = kkt.reduced_hessian_min_eigenvalue;
    certificate.max_violation = candidate.max_violation;
    certificate.starts = out.starts;
    certificate.distinct_solutions = out.distinct_solutions;
    out.candidates.push_back(candidate);
    out.certificates.push_back(certificate);
    out.points.push_back(x);
  }
  out.evaluations = formulation.evaluations();
  if (out.candidates.empty() || nearest.violation > kFeasible) {
    out.status = out.stopped ? PlanStatus::Limit : PlanStatus::Infeasible;
  } else {
    out.status = out.stopped ? PlanStatus::Limit : PlanStatus::Feasible;
  }
  return out;
}

PlanStatus status_of(const Certificate& certificate) {
  if (!(certificate.max_violation <= kFeasible)) return PlanStatus::Infeasible;
  return certificate.kkt_residual <= kOptimal ? PlanStatus::Optimal : PlanStatus::Feasible;
}

}  // namespace stillbase
