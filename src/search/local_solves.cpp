#include "search/local_solves.hpp"

#include <algorithm>
#include <stdexcept>

#include <stillbase/core/constants.hpp>

#include "formulation/projection.hpp"
#include "search/kink.hpp"
#include "search/zero_watch.hpp"

namespace stillbase {

namespace {

/// Whether what a solver leaves is meant to be a minimum.
bool ends_at_minima(const nlp::OptimizerInfo& info) {
  return info.uses_gradient && !info.global && info.name != "gradient-projection";
}

}  // namespace

LocalSolves::LocalSolves(const CaptureProblem& problem, const Formulation& formulation,
                         const SearchOptions& options)
    : problem_(problem),
      formulation_(formulation),
      options_(options),
      optimizer_(nlp::make_optimizer(options.optimizer)),
      rescuer_(nlp::make_optimizer(options.rescuer)) {
  if (!optimizer_) throw std::invalid_argument("no optimizer named " + options.optimizer);
  const bool has_minima = ends_at_minima(optimizer_->info());
  looks_for_zeros_ = formulation.has_hessian() && has_minima;
  if (!has_minima || options.optimizer == options.rescuer) rescuer_.reset();
}

nlp::OptimizeOptions LocalSolves::limits(int start) const {
  nlp::OptimizeOptions out;
  out.max_evaluations =
      simulates_turn(problem_) ? options_.max_simulated_evaluations : options_.max_evaluations;
  out.stop = options_.stop;
  out.optimality_tolerance = kOptimal;
  out.far = options_.far;
  out.seed = options_.seed + static_cast<std::uint64_t>(start);
  return out;
}

nlp::OptimizeOptions LocalSolves::brief_limits(int start) const {
  nlp::OptimizeOptions out = limits(start);
  out.max_evaluations = std::min(out.max_evaluations, options_.max_rescue_evaluations);
  return out;
}

Solution LocalSolves::solve_by(const nlp::Optimizer& optimizer, const Eigen::VectorXd& x0,
                               const nlp::OptimizeOptions& limits, Calls& calls) const {
  bool at_kink = false;  // of the last solve
  const Eigen::VectorXd x = formulation_.normalised(
      solved_in_shortest_turns(formulation_, x0, [&](const Eigen::VectorXd& from) {
        ++calls[optimizer.info().name];
        LocalEnd end;
        if (looks_for_zeros_) {
          end = minimize_to_zero(optimizer, formulation_, from, limits);
        } else {
          const nlp::OptimizeResult result = optimizer.minimize(formulation_, from, limits);
          end = {result.x, result.at_kink};
        }
        at_kink = end.at_kink;
        return end.x;
      }));
  Solution found = polish(problem_, formulation_, judge(problem_, formulation_, x));
  found.at_kink = at_kink && formulation_.distance(found.x, x) <= options_.minima.same_minimum;
  return found;
}

Solution LocalSolves::solve(const Eigen::VectorXd& x0, int start, Calls& calls) const {
  return solve_by(*optimizer_, x0, limits(start), calls);
}

Solution LocalSolves::minimum(const Eigen::VectorXd& x0, int start, Calls& calls) const {
  const Solution found = solve(x0, start, calls);
  return stopped_short(found) ? rescued(found, start, calls) : found;
}

bool LocalSolves::stopped_short(const Solution& found) const {
  return rescuer_ && found.violation <= kFeasibilityTolerance && !found.at_kink &&
         !options_.stop.reached() &&
         !is_stationary(formulation_, found.x, {.stationary = kOptimal});
}

Solution LocalSolves::rescued(const Solution& from, int start, Calls& calls) const {
  const Solution further = solve_by(*rescuer_, from.x, brief_limits(start), calls);
  return better(further, from) ? further : from;
}

}  // namespace stillbase
