#include "formulation/measures/measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <stillbase/formulation/measures/robust.hpp>

#include "formulation/formulation_parts.hpp"
#include "formulation/measures/residual.hpp"
#include "formulation/measures/scenario_program.hpp"
#include "formulation/projection.hpp"
#include "nlp/refinement.hpp"

namespace stillbase {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

std::vector<Scenario> scenarios_of(const std::vector<ConeMaximum>& maxima) {
  std::vector<Scenario> out;
  out.reserve(maxima.size());
  for (const ConeMaximum& maximum : maxima) out.push_back(maximum.scenario);
  return out;
}

nlp::OptimizeOptions roughly(const nlp::OptimizeOptions& options, const RoughLimits& limits) {
  nlp::OptimizeOptions out = options;
  out.max_evaluations = std::min(options.max_evaluations, limits.evaluations);
  out.feasibility_tolerance = limits.violation;
  out.optimality_tolerance = limits.kkt_residual;
  out.explain_infeasibility = false;
  return out;
}

}  // namespace

Measure::Measure(const CaptureProblem& problem, const Formulation& formulation,
                 const MeasureOptions& options)
    : problem_(problem), formulation_(formulation), options_(options) {
  const RiskMeasure kind = problem.measure.kind;
  if (kind == RiskMeasure::Expectation || kind == RiskMeasure::Cvar) {
    samples_ = mean_scenarios(problem);
  }
  weights_.resize(static_cast<Eigen::Index>(samples_.size()));
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    weights_[static_cast<Eigen::Index>(k)] = samples_[k].weight;
  }
}

double Measure::half_square(double value) const {
  const double ratio = formulation_.objective_power().length(value) / formulation_.objective_unit();
  return ratio * ratio / 2;
}

std::optional<double> Measure::level() const {
  if (problem_.measure.kind == RiskMeasure::Cvar) return problem_.measure.cvar_level;
  return std::nullopt;
}

double Measure::value(const Eigen::VectorXd& x) {
  if (is_nominal()) {
    nlp::Evaluation here;
    formulation_.evaluate_value(x, here);
    return here.objective;
  }
  if (problem_.measure.kind == RiskMeasure::WorstCase) {
    const WorstCase worst = worst_at(x);
    return worst.is_complete ? half_square(worst.value) : kUnknown;
  }
  if (const Known here = known(x); here.sampled) return *here.sampled;
  const double value = sampled_value(x);
  if (std::isfinite(value)) remember(x, [&](Known& here) { here.sampled = value; });
  return value;
}

double Measure::sampled_value(const Eigen::VectorXd& x) {
  ScenarioEvaluation here;
  formulation_.evaluate_scenarios(x, samples_, false, here);
  if (here.values.hasNaN()) return kUnknown;
  return level() ? tail_mean(here.values, weights_, *level()).mean : weights_.dot(here.values);
}

WorstCase Measure::worst_at(const Eigen::VectorXd& x) {
  if (const Known here = known(x); here.worst) return *here.worst;
  WorstCase worst = worst_case(problem_, formulation_, formulation_.configuration(x));
  if (worst.is_complete) remember(x, [&](Known& here) { here.worst = worst; });
  return worst;
}

bool Measure::knows(const Eigen::VectorXd& x) {
  const Known here = known(x);
  return here.worst && (samples_.empty() || here.sampled);
}

Measure::Known Measure::known(const Eigen::VectorXd& x) {
  const std::lock_guard lock(mutex_);
  const auto at = find_known(x);
  return at != known_.end() ? *at : Known{};
}

std::vector<Measure::Known>::iterator Measure::find_known(const Eigen::VectorXd& x) {
  return std::find_if(known_.begin(), known_.end(), [&x](const Known& one) {
    return one.x[0] == x[0] && one.x == x;  // hundreds of points, nearly all differ at once
  });
}

template <class Add>
void Measure::remember(const Eigen::VectorXd& x, const Add& add) {
  const std::lock_guard lock(mutex_);
  auto at = find_known(x);
  if (at == known_.end()) at = known_.insert(at, Known{.x = x});
  add(*at);
}

MeasureSolution RoughSolution::given_up_at(double hopeless) const {
  const auto at = std::find_if(rounds.begin(), rounds.end(),
                               [&](const Round& round) { return round.reached > hopeless; });
  if (at != rounds.end()) return *at;
  return *this;
}

double Measure::reported(const Eigen::VectorXd& x) {
  const Configuration configuration = formulation_.configuration(x);
  if (is_nominal()) return nominal_value(problem_, formulation_, configuration);
  if (problem_.measure.kind == RiskMeasure::WorstCase) {
    const WorstCase worst = worst_at(x);
    return worst.is_complete ? worst.value : kUnknown;
  }
  return formulation_.objective_power().value(formulation_.objective_unit() *
                                              std::sqrt(2 * value(x)));
}

RoughSolution Measure::minimize_roughly(const nlp::Optimizer& optimizer,
                                        const nlp::OptimizeOptions& options,
                                        const Eigen::VectorXd& x0, const RoughLimits& limits) {
  if (problem_.measure.kind == RiskMeasure::WorstCase) {
    return exchange(optimizer, options, x0, limits);
  }
  if (has_residual(problem_)) {
    return {finish(optimizer, roughly(options, limits), x0), {}};
  }
  return {{x0, 0}, {}};
}

MeasureSolution Measure::finish(const nlp::Optimizer& optimizer,
                                const nlp::OptimizeOptions& options, const Eigen::VectorXd& x0) {
  if (problem_.measure.kind == RiskMeasure::WorstCase) {
    MeasureSolution first = follow(optimizer, options, x0);
    if (first.at_kink || certify(first.x).kkt_residual <= options.optimality_tolerance)
      return first;
    // The set of maxima has changed: a second round from cuts that hold everywhere.
    const RoughLimits exact{.evaluations = 60,
                            .violation = options.feasibility_tolerance,
                            .kkt_residual = options.optimality_tolerance,
                            .projected = options.feasibility_tolerance};
    const MeasureSolution nearer = exchange(optimizer, options, first.x, exact);
    MeasureSolution second = follow(optimizer, options, nearer.x);
    const int calls = first.solver_calls + nearer.solver_calls + second.solver_calls;
    MeasureSolution& best = value(second.x) < value(first.x) ? second : first;
    best.solver_calls = calls;
    return best;
  }
  int calls = 0;
  const auto solved = [&](const auto& solve) {
    return solved_in_shortest_turns(formulation_, x0, [&](const Eigen::VectorXd& from) {
      ++calls;
      return solve(from);
    });
  };
  if (is_nominal()) {
    const Eigen::VectorXd x = solved([&](const Eigen::VectorXd& from) {
      return optimizer.minimize(formulation_, from, options).x;
    });
    return {x, calls};
  }
  const double scale = value(x0);
  if (!(scale > 0)) return {x0, 0};  // nothing left to improve
  const ScenarioProgram program(formulation_, samples_, level(), scale);
  const Eigen::VectorXd x = solved([&](const Eigen::VectorXd& from) {
    return Eigen::VectorXd(
        optimizer.minimize(program, program.lifted(from), options).x.head(x0.size()));
  });
  return {x, calls};
}

std::vector<ConeMaximum> Measure::maxima_at(const Eigen::VectorXd& x) const {
  return cone_maxima(problem_, formulation_, formulation_.configuration(x));
}

bool Measure::is_closed_form() const { return formulation_.parts().differenced.empty(); }

std::vector<Scenario> Measure::first_directions(const std::vector<ConeMaximum>& worst,
                                                int rim_directions) const {
  // Where each direction is simulated the worst ones alone have to do.
  std::vector<Scenario> out;
  if (is_closed_form()) out = outer_scenarios(problem_, rim_directions);
  for (const Scenario& scenario : scenarios_of(worst)) out.push_back(scenario);
  return out;
}

RoughSolution Measure::exchange(const nlp::Optimizer& optimizer,
                                const nlp::OptimizeOptions& options, const Eigen::VectorXd& x0,
                                const RoughLimits& limits) {
  const nlp::OptimizeOptions rough = roughly(options, limits);
  RoughSolution out{{x0, 0}, {}};
  std::vector<ConeMaximum> worst = maxima_at(x0);
  std::vector<Scenario> active = first_directions(worst, limits.rim_directions);
  Eigen::VectorXd x = x0;
  double least = worst.front().value;
  for (int round = 0; round < options_.rounds; ++round) {
    const double scale = half_square(worst.front().value);
    if (!(scale > 0) || (round > 0 && options.stop.reached())) break;
    const ScenarioProgram program(formulation_, active, scale);
    const nlp::OptimizeResult result = optimizer.minimize(program, program.lifted(x), rough);
    ++out.solver_calls;
    if (!result.feasible) break;
    const ProjectionResult end = project_onto_constraints(
        formulation_, in_shortest_turns(formulation_, result.x.head(x0.size())), false,
        limits.projection_steps);
    if (!(end.violation <= limits.projected)) break;
    x = end.x;
    worst = maxima_at(x);
    if (round == 0 || worst.front().value < least) {  // x0 may break constraints
      least = worst.front().value;
      out.x = x;
    }
    const double reached = program.lifted(x)[x0.size()] * scale;
    out.rounds.push_back({out, reached});
    if (half_square(worst.front().value) <= reached * (1 + options_.near)) break;
    if (reached > limits.hopeless) break;
    for (const ConeMaximum& maximum : worst) {
      if (half_square(maximum.value) > reached) active.push_back(maximum.scenario);
    }
  }
  return out;
}

MeasureSolution Measure::follow(const nlp::Optimizer& optimizer,
                                const nlp::OptimizeOptions& options, const Eigen::VectorXd& x0) {
  MeasureSolution out{x0, 0};
  nlp::OptimizeOptions solve = options;
  if (is_closed_form()) {
    solve.max_evaluations = std::min(options.max_evaluations, options_.evaluations);
  }
  std::vector<ConeMaximum> worst = maxima_at(x0);
  for (int round = 0; round < options_.rounds; ++round) {
    const double scale = half_square(worst.front().value);
    if (!(scale > 0) || (round > 0 && options.stop.reached())) break;
    std::vector<Scenario> following;
    for (const ConeMaximum& maximum : worst) {
      if (half_square(maximum.value) >= options_.counting_maximum * scale)
        following.push_back(maximum.scenario);
    }
    const ScenarioProgram program(formulation_, following, scale, &problem_);
    const nlp::OptimizeResult result = optimizer.minimize(program, program.lifted(out.x), solve);
    ++out.solver_calls;
    const Eigen::VectorXd x = in_shortest_turns(formulation_, result.x.head(x0.size()));
    out.at_kink = result.at_kink && formulation_.distance(x, out.x) <= options_.same_point;
    if (x == out.x) break;  // another round would repeat this one
    worst = maxima_at(x);
    // A maximum that was left out may have taken over: then x0 stays better.
    if (!result.feasible || half_square(worst.front().value) > scale * (1 + 1e-12)) break;
    out.x = x;
    // No maximum is above those that were followed, and there is no way down.
    out.at_kink = result.at_kink && half_square(worst.front().value) <=
                                        result.objective * scale * (1 + options_.same_value);
    if (out.at_kink || certify(x).kkt_residual <= options_.finished) break;
  }
  return out;
}

nlp::Certificate Measure::certify(const Eigen::VectorXd& x) {
  if (is_nominal()) return nlp::certify(formulation_, x, {.second_order = true});
  if (const Known here = known(x); here.certificate) return *here.certificate;
  const nlp::Certificate certificate = certificate_at(x);
  // Of what is simulated a stop may have come before all directions were known.
  if (is_closed_form()) remember(x, [&](Known& here) { here.certificate = certificate; });
  return certificate;
}

nlp::Certificate Measure::certificate_at(const Eigen::VectorXd& x) {
  const double size = value(x);
  const double scale = size > options_.zero * options_.zero / 2 ? size : 1;
  if (problem_.measure.kind == RiskMeasure::WorstCase) {
    const auto maxima = cone_maxima(problem_, formulation_, formulation_.configuration(x));
    const ScenarioProgram program(formulation_, scenarios_of(maxima), scale);
    // First order only: worst directions that change with x add curvature which fixed ones lack.
    return nlp::certify(program, program.lifted(x));
  }
  const ScenarioProgram program(formulation_, samples_, level(), scale);
  return nlp::certify(program, program.lifted(x), {.second_order = true});
}

Eigen::VectorXd Measure::refined(const Eigen::VectorXd& x) {
  // CVaR has a variable per sample: a step would cost as much as the whole solve.
  if (!formulation_.has_hessian() || level()) return x;
  const double size = value(x);
  if (!(size > options_.zero * options_.zero / 2)) return x;
  const auto refined_in = [&x](const ScenarioProgram& program) -> Eigen::VectorXd {
    return nlp::refined_minimum(program, program.lifted(x)).head(x.size());
  };
  if (problem_.measure.kind != RiskMeasure::WorstCase)
    return refined_in({formulation_, samples_, std::nullopt, size});
  return refined_in({formulation_, scenarios_of(maxima_at(x)), size, &problem_});
}

}  // namespace stillbase
