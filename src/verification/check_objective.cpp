// Objective, worst case over the cone of directions, constraint list and certificate.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/worst_direction.hpp"

namespace stillbase::verification {
namespace {

struct Named {
  const char* name;
  const char* unit;
};
Named names_of(ObjectiveQuantity quantity) {
  switch (quantity) {
    case ObjectiveQuantity::BaseAngularMomentum:
      return {"base_angular_momentum", "N m s"};
    case ObjectiveQuantity::BaseAngularVelocity:
      return {"base_angular_velocity", "rad/s"};
    case ObjectiveQuantity::TotalAngularMomentum:
      return {"total_angular_momentum", "N m s"};
  }
  return {"", ""};
}

}  // namespace

void check_objective(const Context& context, const ContactEvent& event,
                     const PostureResponse& response, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const ObjectiveValue& stated = context.plan.objective;
  const double tolerance = context.options.recompute_tolerance;
  const Named names = names_of(problem.objective);

  std::vector<std::string> objections;
  if (stated.name != names.name) objections.push_back("name is " + stated.name);
  if (stated.unit != names.unit) objections.push_back("unit is " + stated.unit);
  claims.none_wrong("objective_name", objections,
                    fmt::format("{} in {}", names.name, names.unit));

  auto value = [&](const Vector3d& d) {
    return objective_value(problem.objective, response,
                           impulse_along(problem, event, response, d));
  };
  auto scale = [&](const Vector3d& d) {
    return objective_scale(problem.objective, response,
                           impulse_along(problem, event, response, d));
  };
  const double nominal = value(event.n);
  claims.same("objective_nominal", relative_error(stated.nominal, nominal, scale(event.n)),
              tolerance, fmt::format("{:.9g} {}", nominal, names.unit));

  const double half_angle = problem.uncertainty.cone_half_angle;
  if (!(half_angle > 0)) {
    claims.same("objective_worst_case",
                relative_error(stated.worst_case, nominal, scale(event.n)), tolerance,
                "without a cone the nominal value");
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
                tolerance, fmt::format("{:.9g} {} along the stated direction", value(d), names.unit));
  } else {
    claims.not_evaluated("objective_worst_case", tolerance, "1", "no worst direction is stated");
  }

  const WorstDirection worst =
      worst_over_cone(value, event.n, half_angle, plane, context.options.cone_samples);
  const double excess = (worst.value - stated.worst_case) /
                        std::max(std::abs(stated.worst_case), 1e-6 * scale(event.n));
  claims.at_most("worst_case_sampled", excess, context.options.cone_tolerance, "1",
                 fmt::format("{:.9g} {} found along ({:.6f}, {:.6f}, {:.6f}), relative excess over "
                             "the stated worst case",
                             worst.value, names.unit, worst.direction.x(), worst.direction.y(),
                             worst.direction.z()));
}

void check_constraints(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  double largest = 0, mismatch = 0;
  std::vector<std::string> broken;
  for (const ConstraintValue& c : plan.constraints) {
    const double violation = std::max({c.lower - c.value, c.value - c.upper, 0.0});
    mismatch = std::max(mismatch, std::abs(violation - c.violation));
    largest = std::max(largest, violation);
    if (violation > context.options.hand_position_tolerance) broken.push_back(c.name);
  }
  claims.at_most("constraint_violations", mismatch, 1e-12, "1",
                 "stated violation of each constraint against its value and bounds");
  claims.at_most("constraint_values", largest, context.options.hand_position_tolerance, "1",
                 broken.empty() ? "largest stated violation"
                                : fmt::format("largest stated violation: {}", broken.front()));
  claims.same("certificate_violation",
              relative_error(plan.certificate.max_violation, largest, 1e-6), 1e-6,
              "largest violation in the certificate");
}

void check_candidates(const Context& context, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const Plan& plan = context.plan;
  const VerifyOptions& options = context.options;
  double worst_nominal = 0, worst_cone = 0, nearest = kInfinity;
  std::vector<std::string> objections;
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    if (options.stop.reached()) {
      objections.push_back(fmt::format("stopped before candidate {}", i));
      break;
    }
    const Candidate& candidate = plan.candidates[i];
    const Configuration& at = candidate.configuration;
    const PostureResponse response = posture_response(problem, at.phi);
    const ContactEvent event = contact_event(problem, context.motion, at);
    auto value = [&](const Vector3d& d) {
      return objective_value(problem.objective, response,
                             impulse_along(problem, event, response, d));
    };
    const double scale = objective_scale(problem.objective, response,
                                         impulse_along(problem, event, response, event.n));
    worst_nominal = std::max(worst_nominal,
                             relative_error(candidate.objective, value(event.n), scale));
    const WorstDirection worst =
        worst_over_cone(value, event.n, problem.uncertainty.cone_half_angle,
                        problem.uncertainty.cone_plane_normal, options.cone_samples);
    worst_cone = std::max(worst_cone, std::abs(candidate.worst_case - worst.value) /
                                          std::max(std::abs(worst.value), 1e-6 * scale));
    const PoseError base = pose_error(at.base, plan.configuration.base);
    nearest = std::min(nearest, std::max({(at.phi - plan.configuration.phi).norm(), base.largest(),
                                          std::abs(at.contact_time -
                                                   plan.configuration.contact_time)}));
  }
  claims.none_wrong("candidates", objections,
                    fmt::format("{} recomputed", plan.candidates.size()));
  claims.at_most("candidates_objective", worst_nominal, options.recompute_tolerance, "1",
                 "largest relative difference over the candidates");
  claims.at_most("candidates_worst_case", worst_cone, options.cone_tolerance, "1",
                 "largest relative difference to the sampled worst case over the candidates");
  claims.at_most("configuration_is_candidate", nearest, 1e-9, "1",
                 "the chosen configuration from the nearest candidate");
}

}  // namespace stillbase::verification
