// The section `constraints`.
#include "io/fields/sections.hpp"

namespace stillbase::io {

void constraints_fields(Table& t, CaptureProblem& problem) {
  ConstraintSpec& constraints = problem.constraints;
  t("case", Word(constraints.impact_case, kCaseConstraintNames),
    "`none`, `C` (C1 or C2), `C1`, `C2`, `G2`, `G3`");
  t("joint_limit_margin",
    Number(constraints.joint_limit_margin, Dimension::JointPosition, kNonNegative),
    "kept from every joint limit");
  t("closing_speed_min", Number(constraints.closing_speed_min, Dimension::Velocity, kPositive),
    "smallest closing speed; without it the best plan would be to miss the target");
  t("joint_rate_scale", Number(constraints.joint_rate_scale, kPositive),
    "the joint rates right after the nominal impact stay below this part of the robot file's "
    "limits");
  t("joint_rate_max",
    JointValues(constraints.joint_rate_max, problem.robot, kJointVelocity, kPositive),
    "instead: limits of their own");
  t.not_both("joint_rate_scale", "joint_rate_max");
  const Range singular{.lower = 0, .upper = 1e9};
  t("coupling_singular_value_min",
    Number(constraints.coupling_singular_value_min, Dimension::Inertia, singular),
    "lower bound of the smallest singular value of the angular coupling matrix, so that the arm "
    "can push against every direction of the base; of those that are not zero in every posture "
    "(one of a planar robot); 0: no bound");
  t("jacobian_singular_value_min",
    Number(constraints.jacobian_singular_value_min, Dimension::Length, singular),
    "the same of the generalized Jacobian, its angular rows times `jacobian_length`");
  t("jacobian_length", Number(constraints.jacobian_length, Dimension::Length, kPositive),
    "converts angles into lengths there");
  t("clearance", Number(constraints.clearance, Dimension::Length, kNonNegative),
    "the search keeps this distance at the contact between the shapes of arm, base, base-fixed "
    "obstacles and target; see `constraints.clearance` in problems/README.md");
}

}  // namespace stillbase::io
