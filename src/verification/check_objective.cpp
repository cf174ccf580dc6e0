// Objective and its worst case over the cone of directions.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/worst_direction.hpp"

namespace stillbase::verification {
namespace {

/// The quantity of a term in its own unit.
std::vector<ObjectiveTerm> alone(ObjectiveTerm term) {
  term.size = 1;
  return {term};
}

/// Directions before the local refinement: few where each of them is simulated.
int cone_samples(const Context& context) {
  constexpr int kSimulated = 60;
  const int most = context.options.cone_samples;
  return simulates_turn(context.problem) ? std::min(kSimulated, most) : most;
}

/// Value of the problem's measure, by `reference`.
double measure_value(const CaptureProblem& problem, const TargetMotion* motion,
                     const ContactEvent& event, const PostureResponse& response,
                     const Configuration& at, double worst) {
  switch (problem.measure.kind) {
    case RiskMeasure::Nominal:
      return objective_value(problem, response, impulse_along(problem, event, response, event.n));
    case RiskMeasure::WorstCase:
      return worst;
    case RiskMeasure::Expectation:
    case RiskMeasure::Cvar:
      return sampled_measure(problem, motion, at, response);
  }
  return 0;
}

/// The posture that the prediction alone would have chosen: its numbers, and that it is one.
void check_nominal_optimum(const Context& context, ClaimList& claims) {
  if (!context.plan.nominal_optimum) return;
  const NominalOptimum& stated = *context.plan.nominal_optimum;
  const ObjectiveNumbers found = objective_numbers(context, stated.configuration);
  const double tolerance =
      objective_tolerance(context.problem, context.options.recompute_tolerance);
  const double worst_tolerance = std::max(tolerance, context.options.worst_case_tolerance);
  claims.same("nominal_optimum_nominal", relative_error(stated.nominal, found.nominal, found.scale),
              tolerance, fmt::format("{:.9g}", found.nominal));
  claims.same("nominal_optimum_worst_case",
              relative_error(stated.worst_case, found.worst_case, found.scale), worst_tolerance,
              fmt::format("{:.9g}", found.worst_case));
  claims.same("nominal_optimum_value", relative_error(stated.value, found.measure, found.scale),
              context.problem.measure.kind == RiskMeasure::WorstCase ? worst_tolerance : tolerance,
              fmt::format("{:.9g} of the measure", found.measure));
  claims.at_most("nominal_optimum_is_lowest",
                 (found.nominal - context.plan.objective.nominal) / std::max(found.scale, 1e-300),
                 1e-6, "1", "its nominal value above that of the plan, relative to the scale");
}

}  // namespace

ObjectiveNumbers objective_numbers(const Context& context, const Configuration& at) {
  const CaptureProblem problem = problem_at(context.problem, at);
  const PostureResponse response = posture_response(problem, at.phi);
  const auto motion = target_motion(
      problem, at, at.base * Vector3d(response.dynamics.hand_position), at.contact_time);
  const TargetMotion* moving = motion ? &*motion : nullptr;
  const ContactEvent event = contact_event(problem, moving, at);
  auto value = [&](const Vector3d& d) {
    return objective_value(problem, response, impulse_along(problem, event, response, d));
  };
  ObjectiveNumbers out;
  out.scale = objective_scale(problem.objective, response,
                              impulse_along(problem, event, response, event.n));
  out.nominal = value(event.n);
  out.worst_case = worst_over_cone(value, event.n, problem.uncertainty.cone_half_angle,
                                   problem.uncertainty.cone_plane_normal, cone_samples(context))
                       .value;
  out.measure = measure_value(problem, moving, event, response, at, out.worst_case);
  return out;
}

void check_objective(const Context& context, const ContactEvent& event,
                     const PostureResponse& response, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const ObjectiveValue& stated = context.plan.objective;
  const double tolerance = objective_tolerance(problem, context.options.recompute_tolerance);
  const std::string name = objective_name(problem), unit = objective_unit_name(problem);

  std::vector<std::string> objections;
  if (stated.name != name) objections.push_back("name is " + stated.name);
  if (stated.unit != unit) objections.push_back("unit is " + stated.unit);
  claims.none_wrong("objective_name", objections, fmt::format("{} in {}", name, unit));

  auto value = [&](const Vector3d& d) {
    return objective_value(problem, response, impulse_along(problem, event, response, d));
  };
  auto scale = [&](const Vector3d& d) {
    return objective_scale(problem.objective, response, impulse_along(problem, event, response, d));
  };
  const double nominal = value(event.n);
  claims.same("objective_nominal", relative_error(stated.nominal, nominal, scale(event.n)),
              tolerance, fmt::format("{:.9g} {}", nominal, unit));

  double worst_term = 0;
  for (const ObjectiveTerm& term : problem.objective) {
    const auto found = stated.terms.find(to_string(term.quantity));
    const Vector6d Fbar = impulse_along(problem, event, response, event.n);
    worst_term = std::max(
        worst_term, found == stated.terms.end()
                        ? kInfinity
                        : relative_error(found->second, term_value(problem, term, response, Fbar),
                                         objective_scale(alone(term), response, Fbar)));
  }
  claims.same("objective_terms", worst_term, tolerance, "each term in its own unit");
  check_nominal_optimum(context, claims);

  const double half_angle = problem.uncertainty.cone_half_angle;
  const bool sampled =
      problem.measure.kind == RiskMeasure::Expectation || problem.measure.kind == RiskMeasure::Cvar;
  const double wanted = problem.measure.kind == RiskMeasure::WorstCase ? stated.worst_case
                        : !stated.is_judged
                            ? stated.nominal
                            : measure_value(problem, context.motion, event, response,
                                            context.plan.configuration, stated.worst_case);
  claims.same("objective_value", relative_error(stated.value, wanted, scale(event.n)), tolerance,
              fmt::format("{:.9g} {} of the measure{}", wanted, unit,
                          !stated.is_judged ? ", which was not worked out before the limit"
                          : sampled         ? ", over the samples that the seed gives"
                                            : ""));
  if (!(half_angle > 0)) {
    claims.same("objective_worst_case", relative_error(stated.worst_case, nominal, scale(event.n)),
                tolerance, "without a cone the nominal value");
    return;
  }

  const Vector3d& d = stated.worst_direction;
  const auto& plane = problem.uncertainty.cone_plane_normal;
  double outside = std::max(std::abs(d.norm() - 1), angle_between(d, event.n) - half_angle);
  if (plane) outside = std::max(outside, std::abs(plane->dot(d - event.n)));
  claims.at_most("worst_direction", outside, 1e-9, "rad",
                 "the stated worst direction is a direction of the cone");
  if (d.norm() > 0) {
    claims.same("objective_worst_case", relative_error(stated.worst_case, value(d), scale(d)),
                tolerance, fmt::format("{:.9g} {} along the stated direction", value(d), unit));
  } else {
    claims.not_evaluated("objective_worst_case", tolerance, "1", "no worst direction is stated");
  }

  if (!stated.is_judged) {
    claims.at_least("worst_case_sampled", stated.worst_case, stated.nominal,
                    tolerance * std::abs(stated.nominal), unit,
                    "the largest over some directions, no less than the predicted value; a limit "
                    "came before the others");
    return;
  }
  const WorstDirection worst =
      worst_over_cone(value, event.n, half_angle, plane, cone_samples(context));
  const double excess = (worst.value - stated.worst_case) /
                        std::max(std::abs(stated.worst_case), 1e-6 * scale(event.n));
  claims.at_most("worst_case_sampled", excess, context.options.cone_tolerance, "1",
                 fmt::format("{:.9g} {} found along ({:.6f}, {:.6f}, {:.6f}), relative excess over "
                             "the stated worst case",
                             worst.value, unit, worst.direction.x(), worst.direction.y(),
                             worst.direction.z()));
}

}  // namespace stillbase::verification
