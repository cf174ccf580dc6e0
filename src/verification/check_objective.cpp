// Objective and its worst case over the cone of directions.
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
  claims.none_wrong("objective_name", objections, fmt::format("{} in {}", names.name, names.unit));

  auto value = [&](const Vector3d& d) {
    return objective_value(problem.objective, response, impulse_along(problem, event, response, d));
  };
  auto scale = [&](const Vector3d& d) {
    return objective_scale(problem.objective, response, impulse_along(problem, event, response, d));
  };
  const double nominal = value(event.n);
  claims.same("objective_nominal", relative_error(stated.nominal, nominal, scale(event.n)),
              tolerance, fmt::format("{:.9g} {}", nominal, names.unit));

  const double half_angle = problem.uncertainty.cone_half_angle;
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
                tolerance,
                fmt::format("{:.9g} {} along the stated direction", value(d), names.unit));
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

}  // namespace stillbase::verification
