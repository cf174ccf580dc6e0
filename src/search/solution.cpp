#include "search/solution.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/impact/summary.hpp>

#include "formulation/projection.hpp"

namespace stillbase {

namespace {

/// Momenta that the problem's case wants to be zero, relative to |f| |r_gh| + |t|.
double case_residual(const CaptureProblem& problem, const Formulation& formulation,
                     const Eigen::VectorXd& x) {
  const CaseConstraint wanted = problem.constraints.impact_case;
  if (wanted == CaseConstraint::None) return 0;
  const Configuration at = formulation.configuration(x);
  const Encounter<double> encounter = formulation.encounter(at);
  const EncounterModel& model = formulation.encounter_model();
  const CaseJudgement found = model.is_rigid_contact()
                                  ? impact_at(problem, model, encounter, at.phi).judgement
                                  : summarize_impact(problem.robot, at.phi, problem.resistance,
                                                     encounter.F, encounter.closing_speed)
                                        .judgement;
  if (wanted == CaseConstraint::G2) return found.base;
  if (wanted == CaseConstraint::G3) return found.coupling;
  return wanted == CaseConstraint::C2 ? std::max({found.total, found.base, found.coupling})
                                      : found.total;
}

}  // namespace

double largest_violation(const CaptureProblem& problem, const Formulation& formulation,
                         const Eigen::VectorXd& x) {
  const double worst = formulation.largest_violation(x);
  const double of_case = case_residual(problem, formulation, x);
  return of_case <= kFeasibilityTolerance ? worst : std::max(worst, of_case);
}

Solution judge(const CaptureProblem& problem, const Formulation& formulation,
               const Eigen::VectorXd& x) {
  nlp::Evaluation at_x;
  formulation.evaluate_value(x, at_x);
  if (std::isnan(at_x.objective)) {  // simulations were given up: this one is still needed
    const double value = nominal_value(problem, formulation, formulation.configuration(x));
    const double size = formulation.objective_power().length(value) / formulation.objective_unit();
    at_x.objective = size * size / 2;
  }
  const double violation = largest_violation(problem, formulation, x);
  return {x, at_x.objective, std::isfinite(at_x.objective) ? violation : kInfinity};
}

bool better(const Solution& a, const Solution& b) {
  const bool fa = a.violation <= kFeasibilityTolerance, fb = b.violation <= kFeasibilityTolerance;
  if (fa != fb) return fa;
  return fa ? a.objective < b.objective : a.violation < b.violation;
}

Solution polish(const CaptureProblem& problem, const Formulation& formulation,
                const Solution& found) {
  Solution best = found;
  const auto consider = [&](const ProjectionResult& moved) {
    if (moved.x == best.x) return;
    const Solution trial = judge(problem, formulation, moved.x);
    if (better(trial, best) && formulation.distance(trial.x, found.x) < 0.1) best = trial;
  };
  consider(project_onto_constraints(formulation, best.x, false, 8));
  if (best.objective < 1e-6 && best.objective > 0) {
    consider(project_onto_constraints(formulation, best.x, true, 20));
  }
  return best;
}

void keep_distinct(const Formulation& formulation, const Solution& found,
                   std::vector<Solution>& solutions, double same) {
  const auto is_same = [&](const Solution& a, const Solution& b) {
    return formulation.are_within(a.x, b.x, same);
  };
  const auto absorb = [](Solution& into, const Solution& other) {
    const int reached = into.reached + other.reached;
    const int family = std::max(into.family, other.family);
    if (better(other, into)) into = other;
    into.reached = reached;
    into.family = family;
  };
  const auto first = std::find_if(solutions.begin(), solutions.end(),
                                  [&](const Solution& one) { return is_same(one, found); });
  if (first == solutions.end()) {
    solutions.push_back(found);
    return;
  }
  absorb(*first, found);
  // A better point took the place of one that it repeats. It may repeat others as well.
  auto known = static_cast<std::size_t>(first - solutions.begin());
  for (std::size_t i = solutions.size(); i-- > 0;) {
    if (i == known || !is_same(solutions[i], solutions[known])) continue;
    absorb(solutions[known], solutions[i]);
    solutions.erase(solutions.begin() + static_cast<std::ptrdiff_t>(i));
    if (i < known) --known;
  }
}

}  // namespace stillbase
