// Variables, encounter, equations and inequalities of a capture problem.
#include "proof/zero_problem.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/impact/gradient.hpp>

namespace stillbase::proof {
namespace {

void set_variables(const CaptureProblem& problem, VariableEncounter& out) {
  const VariableSpec& variables = problem.variables;
  out.start = problem.start;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const auto index = static_cast<std::size_t>(k);
    if (!variables.joints[index]) continue;
    const Joint& joint = problem.robot.joints[index];
    const double margin = problem.constraints.joint_limit_margin;
    out.free.push_back(k);
    out.lower.push_back(joint.lower + margin);
    out.upper.push_back(joint.upper - margin);
  }
  out.attitude_is_free = variables.base_attitude == AttitudeFreedom::Axis;
  out.attitude_axis = variables.base_attitude_axis;
  out.attitude_max = variables.base_attitude_max;
  const bool is_cone = variables.base_attitude == AttitudeFreedom::Cone;
  if (is_cone || variables.base_attitude == AttitudeFreedom::Free) {
    for (int i = 0; i < 3; ++i) out.turn_basis.push_back(Vector3d::Unit(i));
    // A cone does not limit the rotation as a whole.
    if (!is_cone) out.turn_size_max = std::tan(std::min(out.attitude_max, M_PI) / 4);
  }
  out.time_lower = variables.contact_time_lower;
  out.time_upper = variables.contact_time_upper;
  out.time_is_free = out.time_upper > out.time_lower;
}

/// Over a span of times the target's motion is enclosed; at a fixed one the planner's doubles
/// count.
void set_target(const CaptureProblem& problem, VariableEncounter& out) {
  out.estimate = problem.target_state;
  out.R_NT = target_kinematics<double>(out, out.time_lower).R_NT;
  if (!out.time_is_free) return;
  const double rate =
      std::max({out.estimate.angular_velocity.norm(), out.estimate.linear_velocity.norm(),
                1 / (out.time_upper - out.time_lower)});
  out.time_unit = std::exp2(-std::round(std::log2(rate)));
  // Boxes are tried enlarged.
  out.spin.emplace(*problem.target, out.estimate, out.time_lower - out.time_unit,
                   out.time_upper + out.time_unit);
}

VariableEncounter variable_encounter(const CaptureProblem& problem) {
  VariableEncounter out;
  static_cast<EncounterModel&>(out) = encounter_model(problem);
  set_variables(problem, out);
  out.R_NB = problem.base.orientation.toRotationMatrix();
  out.base_position = problem.base.position;
  out.stated = encounter_at(out, start_configuration(problem));
  if (out.follows_target()) set_target(problem, out);
  const bool is_in_base = out.hand_point && out.hand_frame == Frame::Base;
  const Vector3d point = out.hand_point ? *out.hand_point : out.stated.contact.point;
  out.stated_hand_point =
      is_in_base ? point
                 : Vector3d(problem.base.orientation.conjugate() * (point - out.base_position));
  return out;
}

}  // namespace

ZeroProblem zero_problem(const CaptureProblem& problem) {
  ZeroProblem out;
  out.robot = problem.robot;
  out.encounter = variable_encounter(problem);
  out.impact_case = problem.constraints.impact_case;
  const ImpactResistance resistance = prepare_resistance(problem.resistance, problem.robot.n());
  out.added_inertia = resistance.added_inertia;
  out.locked = resistance.locked;

  const ConstraintSpec& limits = problem.constraints;
  out.has_limits = limits.joint_rate_scale || limits.joint_rate_max.size() > 0 ||
                   limits.coupling_singular_value_min > 0 ||
                   limits.jacobian_singular_value_min > 0 || limits.clearance;

  const VariableSpec& variables = problem.variables;
  const HandConstraint hand = problem.hand.constraint;
  const bool is_predicted = !problem.impulse.direction;
  const bool has_point = problem.hand.position || is_predicted;
  out.has_hand_point = hand != HandConstraint::None && has_point &&
                       variables.base_position == PositionFreedom::Fixed;
  out.has_hand_axis = hand == HandConstraint::Axis;
  out.has_hand_axes = hand == HandConstraint::Pose;
  std::vector<SideCondition>& sides = out.side_conditions;
  // Where the equations hold these are cosines of 0 or 180 deg (of a rotation by 180 deg at least
  // one is below -1/3): bounds in between exclude more boxes than the planner's zero and no
  // solution.
  if (out.has_hand_axis) sides.push_back({SideKind::HandFacing, 0, -kInfinity, -0.5});
  for (int i = 0; i < 3 && out.has_hand_axes; ++i) {
    sides.push_back({SideKind::PoseFacing, i, 0.5, kInfinity});
  }
  // At a fixed time it is the same everywhere, and a given impulse has no closing speed.
  const double slowest = problem.constraints.closing_speed_min;
  const bool is_slow = out.encounter.stated.closing_speed < slowest &&
                       problem.impulse.source != ImpulseSource::Given;
  if (is_predicted && (out.encounter.time_is_free || is_slow)) {
    sides.push_back({SideKind::ClosingSpeed, 0, slowest, kInfinity});
  }
  for (int i = 0; i < 3 && has_point && variables.base_position == PositionFreedom::Box; ++i) {
    sides.push_back({SideKind::BasePosition, i, variables.base_position_lower[i],
                     variables.base_position_upper[i]});
  }
  if (!out.encounter.turn_basis.empty()) {
    const double size = out.encounter.turn_size_max;
    sides.push_back({SideKind::TurnSize, 0, -kInfinity, size * size});
  }
  if (variables.base_attitude == AttitudeFreedom::Cone) {
    sides.push_back({SideKind::BaseTilt, 0, std::cos(variables.base_attitude_max), kInfinity});
  }
  return out;
}

}  // namespace stillbase::proof
