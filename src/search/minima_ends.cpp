#include "search/minima_ends.hpp"

#include <algorithm>

#include "formulation/projection.hpp"

namespace stillbase {

void MinimaEnds::keep(const Eigen::VectorXd& x, std::vector<Solution>& minima) const {
  const double violation = largest_violation(problem_, formulation_, x);
  if (!(violation <= kFeasibilityTolerance)) return;
  keep_distinct(formulation_, {x, measure_.value(x), violation}, minima,
                options_.same_configuration);
}

long MinimaEnds::finish(const nlp::Optimizer& rescuer, const nlp::OptimizeOptions& solve,
                        std::vector<Solution>& minima) const {
  std::vector<Eigen::VectorXd> seen;
  long calls = 0;
  for (int rescued = 0; !options_.stop.reached();) {
    Solution* const best = best_not_in(seen, minima);
    if (best == nullptr) break;
    if (!is_minimum(best->x)) takes_place_of(*best, measure_.end_by_newton(best->x));
    if (rescued >= options_.rescued_minima || is_minimum(best->x)) {
      seen.push_back(best->x);
      continue;
    }
    ++rescued;
    const MeasureSolution further = measure_.finish(rescuer, solve, best->x);
    calls += further.solver_calls;
    const ProjectionResult exact = project_onto_constraints(formulation_, further.x, false, 8);
    const Eigen::VectorXd x = formulation_.normalised(exact.x);
    const bool in_place = takes_place_of(*best, x);
    seen.push_back(best->x);
    if (!in_place && measure_.value(x) < best->objective) keep(x, minima);
  }
  return calls;
}

bool MinimaEnds::is_minimum(const Eigen::VectorXd& x) const {
  return measure_.certify(x).kkt_residual <= kOptimal;
}

bool MinimaEnds::takes_place_of(Solution& minimum, const Eigen::VectorXd& x) const {
  const double value = measure_.value(x), violation = largest_violation(problem_, formulation_, x);
  if (!(violation <= kFeasibilityTolerance) ||
      !(value <= minimum.objective * (1 + options_.equal_minima)) ||
      !(formulation_.distance(x, minimum.x) <= options_.same_configuration) ||
      !(measure_.certify(x).kkt_residual < measure_.certify(minimum.x).kkt_residual)) {
    return false;
  }
  minimum.x = x;
  minimum.objective = value;
  minimum.violation = violation;
  return true;
}

Solution* MinimaEnds::best_not_in(const std::vector<Eigen::VectorXd>& seen,
                                  std::vector<Solution>& minima) const {
  double lowest = kInfinity;
  for (const Solution& minimum : minima) lowest = std::min(lowest, minimum.objective);
  Solution* best = nullptr;
  for (Solution& minimum : minima) {
    if (!(minimum.objective <= lowest * (1 + options_.equal_minima))) continue;
    if (std::find(seen.begin(), seen.end(), minimum.x) != seen.end()) continue;
    if (best == nullptr || better(minimum, *best)) best = &minimum;
  }
  return best;
}

}  // namespace stillbase
