// Objective and its worst case over the cone of directions.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"

namespace stillbase::verification {
namespace {

void check_terms(const Context& context, ClaimList& claims) {
  const Vector6d Fbar = context.situation.impulse();
  double worst = 0;
  for (const ObjectiveTerm& term : context.problem.objective) {
    const auto& stated = context.plan.objective.terms;
    const auto found = stated.find(to_string(term.quantity));
    const TermCase at{context.problem, term, context.situation.response, Fbar, nullptr};
    worst = std::max(worst, found == stated.end()
                                ? kInfinity
                                : relative_error(found->second, term_value(at), term_scale(at)));
  }
  claims.same("objective_terms", worst, context.objective_tolerance(), "each term in its own unit");
}

/// Stated worst case along the stated direction, and no larger one over the cone.
void check_worst_case(const Context& context, ClaimList& claims) {
  const Situation& situation = context.situation;
  const ObjectiveValue& stated = context.plan.objective;
  const Vector3d &d = stated.worst_direction, &n = situation.event.n;
  const UncertaintySpec& uncertainty = context.problem.uncertainty;
  const double tolerance = context.objective_tolerance();
  double outside =
      std::max(std::abs(d.norm() - 1), angle_between(d, n) - uncertainty.cone_half_angle);
  if (const auto& plane = uncertainty.cone_plane_normal) {
    outside = std::max(outside, std::abs(plane->dot(d - n)));
  }
  claims.at_most("worst_direction", outside, 1e-9, "rad",
                 "the stated worst direction is a direction of the cone");
  if (d.norm() > 0) {
    const double along = objective_along(situation, d);
    claims.same("objective_worst_case",
                relative_error(stated.worst_case, along, scale_along(situation, d)), tolerance,
                fmt::format("{:.9g} {} along the stated direction", along, stated.unit));
  } else {
    claims.not_evaluated("objective_worst_case", tolerance, "1", "no worst direction is stated");
  }

  if (!stated.is_judged) {
    claims.at_least("worst_case_sampled", stated.worst_case, stated.nominal,
                    tolerance * std::abs(stated.nominal), stated.unit,
                    "the largest over some directions of the cone, no less than the nominal value; "
                    "a limit was reached before the other directions");
    return;
  }
  const WorstDirection worst = worst_direction(situation, context.cone_samples());
  const double excess = (worst.value - stated.worst_case) /
                        std::max(std::abs(stated.worst_case), 1e-6 * scale_along(situation, n));
  claims.at_most("worst_case_sampled", excess, context.options.cone_tolerance, "1",
                 fmt::format("{:.9g} {} found along ({:.6f}, {:.6f}, {:.6f}), relative excess over "
                             "the stated worst case",
                             worst.value, stated.unit, worst.direction.x(), worst.direction.y(),
                             worst.direction.z()));
}

}  // namespace

void check_objective(const Context& context, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const Situation& situation = context.situation;
  const ObjectiveValue& stated = context.plan.objective;
  const double tolerance = context.objective_tolerance();
  if (!stated.user_terms.empty()) {
    std::string names;
    for (const std::string& term : stated.user_terms) names += " " + term;
    claims.not_evaluated("objective_nominal", tolerance, "1",
                         "not recomputed: the objective has terms of the user:" + names);
    return;
  }
  const std::string name = objective_name(problem), unit = objective_unit_name(problem);

  Objections objections;
  objections.demand(stated.name == name, "name is " + stated.name);
  objections.demand(stated.unit == unit, "unit is " + stated.unit);
  claims.none_wrong("objective_name", objections, fmt::format("{} in {}", name, unit));

  const double nominal = objective_along(situation, situation.event.n);
  const double scale = scale_along(situation, situation.event.n);
  claims.same("objective_nominal", relative_error(stated.nominal, nominal, scale), tolerance,
              fmt::format("{:.9g} {}", nominal, unit));
  check_terms(context, claims);

  const RiskMeasure kind = problem.measure.kind;
  const double wanted = kind == RiskMeasure::WorstCase ? stated.worst_case
                        : !stated.is_judged            ? stated.nominal
                        : is_sampled(kind)             ? sampled_measure(situation)
                                                       : nominal;
  claims.same("objective_value", relative_error(stated.value, wanted, scale), tolerance,
              fmt::format("{:.9g} {} of the measure{}", wanted, unit,
                          !stated.is_judged  ? ", which was not evaluated before the limit"
                          : is_sampled(kind) ? ", over the samples that the seed gives"
                                             : ""));
  if (problem.uncertainty.cone_half_angle > 0) {
    check_worst_case(context, claims);
  } else {
    claims.same("objective_worst_case", relative_error(stated.worst_case, nominal, scale),
                tolerance, "without a cone the nominal value");
  }
}

}  // namespace stillbase::verification
