// Objective and its worst case over the cone of directions.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/tolerances.hpp"

namespace stillbase::verification {
namespace {

/// Tolerances of a stated worst velocity.
struct WorstVelocityOptions {
  double outside = 1e-6;  ///< of the ellipsoid's size: variances that nearly vanish divide rounding
};
constexpr WorstVelocityOptions kWorstVelocity;

/// Of a value over a stated one. Where all that is added up is zero there is none.
double relative_excess(double found, double stated, double scale) {
  if (found == stated) return 0;
  return (found - stated) / std::max(std::abs(stated), kShared.least_worst_case * scale);
}

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

/// The stated worst direction has norm 1 and is a direction of the cone; without a cone, or with a
/// residual velocity in its place, it is the normal.
void check_worst_direction(const Context& context, ClaimList& claims) {
  const Vector3d &d = context.plan.objective.worst_direction, &n = context.situation.event.n;
  const UncertaintySpec& uncertainty = context.problem.uncertainty;
  const bool is_cone = uncertainty.cone_half_angle > 0 && !uncertainty.residual_velocity;
  const double half_angle = is_cone ? uncertainty.cone_half_angle : 0;
  double outside = std::max(std::abs(d.norm() - 1), angle_between(d, n) - half_angle);
  if (const auto& plane = uncertainty.cone_plane_normal; is_cone && plane) {
    outside = std::max(outside, std::abs(plane->dot(d - n)));
  }
  claims.at_most("worst_direction", outside, kShared.rounding, "rad",
                 is_cone ? "the stated worst direction is a direction of the cone"
                         : "without a cone the stated worst direction is the normal");
}

/// Stated worst case along the stated direction, and no larger one over the cone.
void check_worst_case(const Context& context, ClaimList& claims) {
  const Situation& situation = context.situation;
  const ObjectiveValue& stated = context.plan.objective;
  const Vector3d &d = stated.worst_direction, &n = situation.event.n;
  const double tolerance = context.objective_tolerance();
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
  const double excess = relative_excess(worst.value, stated.worst_case, scale_along(situation, n));
  claims.at_most("worst_case_sampled", excess, context.options.cone_tolerance, "1",
                 fmt::format("{:.9g} {} found along ({:.6f}, {:.6f}, {:.6f}), relative excess over "
                             "the stated worst case",
                             worst.value, stated.unit, worst.direction.x(), worst.direction.y(),
                             worst.direction.z()));
}

/// The residual velocity as the plan states it, and the worst case over it.
void check_residual(const Context& context, const ResidualCase& residual, ClaimList& claims) {
  const ObjectiveValue& stated = context.plan.objective;
  const double tolerance = context.objective_tolerance();
  Objections objections;
  objections.demand(stated.residual.has_value(), "the plan states no residual velocity");
  claims.none_wrong("residual_velocity", objections,
                    "the plan states the velocity that its problem asks for");
  if (!stated.residual) return;
  const ResidualSummary& said = *stated.residual;
  // A hand that moves with the target leaves nothing but rounding.
  const ContactEvent& event = context.situation.event;
  Vector6d of_target;
  of_target << *event.velocity, event.omega;
  claims.same("residual_mean", relative_error(said.velocity, residual.velocity, of_target.norm()),
              tolerance, "nominal relative velocity");
  // Relative to the deviations: linear and angular ones differ in unit.
  Matrix6d difference = said.covariance - residual.covariance;
  for (int i = 0; i < 6; ++i) {
    const double variance = residual.covariance(i, i);
    const double scale = variance > 0 ? 1 / std::sqrt(variance) : 1;
    difference.row(i) *= scale;
    difference.col(i) *= scale;
  }
  claims.same("residual_covariance", difference.cwiseAbs().maxCoeff(), tolerance,
              "carried to the contact by an integration of its own where it is not stated");
  claims.same(
      "residual_separating", std::abs(said.separating - residual.separating), tolerance,
      fmt::format("{:.4g} of the velocities separate along the normal", residual.separating));
  claims.same("residual_deviations", relative_error(said.deviations, residual.deviations), 0,
              fmt::format("{:g} of the problem", residual.deviations));

  const ResidualNumbers found = residual_numbers(context.problem, residual);
  claims.at_most("worst_velocity", residual.distance(said.worst_velocity),
                 1 + kWorstVelocity.outside, "1",
                 "distance of the stated worst velocity from the nominal one, relative to the "
                 "ellipsoid");
  // The terms that cancel grow with the velocities of the ellipsoid.
  const double reach =
      residual.deviations * std::sqrt(residual.covariance.diagonal().head<3>().sum());
  const double scale = scale_along(context.situation, context.situation.event.n) *
                       (1 + reach / std::max(residual.size, 1e-300));
  const double there = residual_along(context.problem, residual, said.worst_velocity);
  claims.same("objective_worst_case", relative_error(stated.worst_case, there, scale), tolerance,
              fmt::format("{:.9g} {} at the stated velocity", there, stated.unit));
  claims.at_most("worst_case_bound",
                 relative_excess(found.worst_case_bound, stated.worst_case, scale),
                 context.options.cone_tolerance, "1",
                 fmt::format("no velocity of the ellipsoid exceeds {:.9g} {}: relative excess over "
                             "the stated worst case",
                             found.worst_case_bound, stated.unit));
}

/// The problem's measure where it was evaluated.
double wanted_measure(const Context& context, const std::optional<ResidualCase>& residual,
                      double nominal) {
  const ObjectiveValue& stated = context.plan.objective;
  const RiskMeasure kind = context.problem.measure.kind;
  if (kind == RiskMeasure::WorstCase) return stated.worst_case;
  if (!stated.is_judged) return stated.nominal;
  if (!is_sampled(kind)) return nominal;
  return residual ? residual_numbers(context.problem, *residual).expectation
                  : sampled_measure(context.situation);
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
  std::optional<ResidualCase> residual;
  if (problem.uncertainty.residual_velocity) residual = residual_case(situation);
  const double wanted = wanted_measure(context, residual, nominal);
  claims.same("objective_value", relative_error(stated.value, wanted, scale), tolerance,
              fmt::format("{:.9g} {} of the measure{}", wanted, unit,
                          !stated.is_judged   ? ", which was not evaluated before the limit"
                          : !is_sampled(kind) ? ""
                          : residual          ? ", over the residual velocity"
                                              : ", over the samples that the seed gives"));
  check_worst_direction(context, claims);
  if (residual) {
    check_residual(context, *residual, claims);
  } else if (problem.uncertainty.cone_half_angle > 0) {
    check_worst_case(context, claims);
  } else {
    claims.same("objective_worst_case", relative_error(stated.worst_case, nominal, scale),
                tolerance, "without a cone the nominal value");
  }
}

}  // namespace stillbase::verification
