#include "search/refinement.hpp"

#include <algorithm>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/parallel.hpp>

#include "formulation/projection.hpp"
#include "nlp/refinement.hpp"

namespace stillbase {

Refinement::Refinement(const CaptureProblem& problem, const Formulation& formulation,
                       Measure& measure, const SearchOptions& options, int jobs)
    : problem_(problem),
      formulation_(formulation),
      measure_(measure),
      options_(options),
      jobs_(jobs) {}

bool Refinement::is_possible() const { return !simulates_turn(problem_) && problem_.user.empty(); }

void Refinement::refine_nominal(std::vector<Solution>& solutions, const Counts& counts) const {
  refine(solutions, counts, [this](const Solution& one) { return nominal(one); });
}

void Refinement::refine_measure(std::vector<Solution>& solutions) const {
  const auto all = [](const Solution&) { return true; };
  refine(solutions, all, [this](const Solution& one) { return by_measure(one); });
}

template <class Refined>
void Refinement::refine(std::vector<Solution>& solutions, const Counts& counts,
                        const Refined& refined) const {
  if (!is_possible()) return;
  const PhaseClock::Phase phase(options_.clock, "search.refinement");
  std::vector<Solution> before = std::move(solutions);
  const auto is_of_curve = [&](const Solution& solution) {
    return std::any_of(before.begin(), before.end(), [&](const Solution& other) {
      return other.family >= 0 &&
             formulation_.are_within(other.x, solution.x, options_.same_configuration);
    });
  };
  std::vector<Solution> after(before.size());
  for_each_index(jobs_, static_cast<int>(before.size()), {}, [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    after[k] = before[k];
    const bool is_done = before[k].is_refined || before[k].family >= 0;
    if (is_done || options_.stop.reached() || !counts(before[k])) return;
    after[k].is_refined = true;
    Solution end = refined(before[k]);
    end.is_refined = true;
    // A curve has counted its starts.
    if (end.x != before[k].x && !is_of_curve(end)) after[k] = end;
  });
  solutions.clear();
  for (const Solution& solution : after)
    keep_distinct(formulation_, solution, solutions, options_.same_configuration);
}

Solution Refinement::nominal(const Solution& from) const {
  if (!is_possible()) return from;
  const bool was_zero = from.length() <= options_.continua.zero;
  const Eigen::VectorXd x =
      was_zero ? rounded_zero(from.x) : nlp::refined_minimum(formulation_, from.x);
  Solution out = judge(problem_, formulation_, formulation_.normalised(x));
  out.reached = from.reached;
  out.family = from.family;
  return takes_place_of(from, out, was_zero ? options_.continua.zero : from.length()) ? out : from;
}

Solution Refinement::by_measure(const Solution& from) const {
  Solution out = from;
  out.x = formulation_.normalised(measure_.refined(from.x));
  out.objective = measure_.value(out.x);
  out.violation = largest_violation(problem_, formulation_, out.x);
  return takes_place_of(from, out, from.length()) ? out : from;
}

/// Where constraints were broken by their tolerance the value was too low by as much.
bool Refinement::takes_place_of(const Solution& from, const Solution& out, double most) const {
  constexpr double kRounding = 1e-10;
  return out.violation <= kFeasibilityTolerance && out.length() <= most + kRounding &&
         formulation_.distance(from.x, out.x) <= options_.minima.same_basin;
}

/// A zero near x. It is seldom alone, and of the place where a solve met the others only the
/// leading digits are the same with another compiler: the others are rounded off.
Eigen::VectorXd Refinement::rounded_zero(const Eigen::VectorXd& x) const {
  constexpr double kPlace = 1e-4;
  const Eigen::VectorXd grid = (x / kPlace).array().round().matrix() * kPlace;
  return project_onto_constraints(
             formulation_, grid.cwiseMax(formulation_.lower()).cwiseMin(formulation_.upper()), true,
             8)
      .x;
}

}  // namespace stillbase
