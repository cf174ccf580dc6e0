// The section `constraints`.
#include <fmt/format.h>

#include "io/problem_reader.hpp"

namespace stillbase::io {

void read_constraints_section(MapReader& map, CaptureProblem& problem) {
  MapReader fields = section(map, "constraints");
  ConstraintSpec& constraints = problem.constraints;
  fields.choice("case", constraints.impact_case, case_constraint_names());
  fields.number("joint_limit_margin", constraints.joint_limit_margin, Dimension::JointPosition,
                kNonNegative);
  fields.number("closing_speed_min", constraints.closing_speed_min, Dimension::Velocity, kPositive);
  double scale = 1;
  if (fields.number("joint_rate_scale", scale, Dimension::None, kPositive)) {
    constraints.joint_rate_scale = scale;
  }
  read_joint_values(fields, "joint_rate_max", problem.robot, Dimension::AngularVelocity,
                    Dimension::Velocity, kPositive, true, Need::Optional,
                    constraints.joint_rate_max);
  if (constraints.joint_rate_scale && fields.has("joint_rate_max")) {
    map.context().add(fields.line_of("joint_rate_max"), "not-used",
                      fmt::format("{}: stands beside joint_rate_scale; state one of them",
                                  fields.path_of("joint_rate_max")));
  }
  fields.number("coupling_singular_value_min", constraints.coupling_singular_value_min,
                Dimension::Inertia, {.lower = 0, .upper = 1e9});
  fields.number("jacobian_singular_value_min", constraints.jacobian_singular_value_min,
                Dimension::Length, {.lower = 0, .upper = 1e9});
  fields.number("jacobian_length", constraints.jacobian_length, Dimension::Length, kPositive);
  double clearance = 0;
  if (fields.number("clearance", clearance, Dimension::Length, kNonNegative)) {
    constraints.clearance = clearance;
  }
  fields.finish();
}

}  // namespace stillbase::io
