// Variables, encounter, equations and inequalities of a capture problem.
#include "proof/zero_problem.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/plan/turns.hpp>

#include "plan/contact_limits.hpp"

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
    const bool has_turns = has_whole_turns(problem, k);
    const bool is_periodic = has_turns || joint.type == JointType::Continuous;
    const double middle = has_turns ? (joint.lower + joint.upper) / 2 : 0;
    out.variables.push_back({VariableKind::Joint, joint.lower + margin, joint.upper - margin,
                             is_periodic, k, Vector3d::Zero(), middle});
  }
  const AttitudeFreedom attitude = variables.base_attitude;
  const double largest = variables.base_attitude_max;
  out.tilt_axis = variables.base_attitude_axis;
  if (attitude == AttitudeFreedom::Axis) {
    out.variables.push_back({VariableKind::BaseAngle, -largest, largest, largest >= kPi.lower(), -1,
                             variables.base_attitude_axis});
  } else if (attitude != AttitudeFreedom::Fixed) {
    // A cone does not limit the rotation as a whole.
    if (attitude == AttitudeFreedom::Free) {
      out.parameter_max = std::tan(std::min(largest, stillbase::kPi) / 4);
    }
    for (int i = 0; i < 3; ++i) {
      out.variables.push_back({VariableKind::BaseParameter, -out.parameter_max, out.parameter_max,
                               false, -1, Vector3d::Unit(i)});
    }
  }
  out.earliest_time = variables.contact_time_lower;
}

/// The target at the earliest time, as the doubles that the planner uses. Over a span of times its
/// motion is enclosed.
void set_target(const CaptureProblem& problem, VariableEncounter& out) {
  const double lower = out.earliest_time, upper = problem.variables.contact_time_upper;
  const bool is_time_free = upper > lower;
  if (out.follows_target()) {
    out.estimate = problem.target_state;
    out.R_NT = target_kinematics<double>(out, lower).R_NT;
    if (is_time_free) {
      const double rate = std::max({out.estimate.angular_velocity.norm(),
                                    out.estimate.linear_velocity.norm(), 1 / (upper - lower)});
      out.time_unit = std::exp2(-std::round(std::log2(rate)));
      // Boxes are tried enlarged.
      out.spin.emplace(*problem.target, out.estimate, lower - out.time_unit, upper + out.time_unit);
    }
  }
  if (is_time_free) {
    out.variables.push_back({VariableKind::Time, lower / out.time_unit, upper / out.time_unit});
  }
}

/// Two unit vectors normal to f and to each other.
std::pair<Vector3d, Vector3d> normals_of(const Vector3d& f) {
  int smallest = 0;
  f.cwiseAbs().minCoeff(&smallest);
  const Vector3d u = f.cross(Vector3d(Vector3d::Unit(smallest))).normalized();
  return {u, f.cross(u).normalized()};
}

VariableEncounter variable_encounter(const CaptureProblem& problem) {
  VariableEncounter out;
  static_cast<EncounterModel&>(out) = encounter_model(problem);
  set_variables(problem, out);
  out.R_NB = problem.base.orientation.toRotationMatrix();
  out.base_position = problem.base.position;
  out.stated = encounter_at(out, start_configuration(problem));
  set_target(problem, out);
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
  // Drives are an inertia on the joint's diagonal like any other.
  for (int k = 0; k < out.robot.n(); ++k) {
    Joint& joint = out.robot.joints[k];
    out.added_inertia[k] += joint.reflected_inertia();
    joint.rotor_inertia = 0;
  }

  out.uncounted_limits = uncounted_limits(problem);

  const VariableSpec& variables = problem.variables;
  const VariableEncounter& encounter = out.encounter;
  const HandConstraint hand = problem.hand.constraint;
  const bool is_predicted = !problem.impulse.direction;
  const bool has_point = problem.hand.position || is_predicted;
  const bool is_at_point = hand != HandConstraint::None && has_point &&
                           variables.base_position == PositionFreedom::Fixed;
  for (int i = 0; i < 3; ++i) {
    if (is_at_point) out.hand_equations.push_back({RowKind::HandPosition, i});
    if (hand == HandConstraint::Pose) out.hand_equations.push_back({RowKind::HandPose, i});
  }
  const auto add = [&out](RowKind kind, int index, double lower, double upper,
                          const Vector3d& direction = Vector3d::Zero()) {
    out.inequalities.push_back({kind, index, direction, lower, upper});
  };
  // Where the equations hold the cosines of axes are those of 0 or 180 deg (of a rotation by 180
  // deg at least one is below -1/3): bounds in between exclude more boxes than the planner's zero
  // and no solution.
  if (hand == HandConstraint::Axis) {
    out.hand_equations.push_back({RowKind::HandAxis, 0, encounter.u});
    out.hand_equations.push_back({RowKind::HandAxis, 1, encounter.v});
    add(RowKind::HandAxis, 0, -kInfinity, -0.5, encounter.n);
  }
  for (int i = 0; i < 3 && hand == HandConstraint::Pose; ++i) {
    add(RowKind::HandAxisAlong, i, 0.5, kInfinity);
  }
  // At a fixed time it is the same everywhere, and a given impulse has no closing speed.
  const double slowest = problem.constraints.closing_speed_min;
  const bool is_slow =
      encounter.stated.closing_speed < slowest && problem.impulse.source != ImpulseSource::Given;
  if (is_predicted && (encounter.has(VariableKind::Time) || is_slow)) {
    add(RowKind::ClosingSpeed, 0, slowest, kInfinity);
  }
  for (int i = 0; i < 3 && has_point && variables.base_position == PositionFreedom::Box; ++i) {
    add(RowKind::BasePosition, i, variables.base_position_lower[i],
        variables.base_position_upper[i]);
  }
  if (encounter.has(VariableKind::BaseParameter)) {
    add(RowKind::Parameters, 0, -kInfinity, encounter.parameter_max * encounter.parameter_max);
  }
  if (variables.base_attitude == AttitudeFreedom::Cone) {
    add(RowKind::BaseTilt, 0, std::cos(variables.base_attitude_max), kInfinity);
  }
  return out;
}

std::vector<Row> all_rows(const ZeroProblem& problem) {
  std::vector<Row> rows = problem.hand_equations;
  const VariableEncounter& encounter = problem.encounter;
  const CaseConstraint wanted = problem.impact_case;
  bool total =
      wanted == CaseConstraint::C || wanted == CaseConstraint::C1 || wanted == CaseConstraint::C2;
  const bool coupling = wanted == CaseConstraint::C2 || wanted == CaseConstraint::G3;
  bool base = wanted == CaseConstraint::G2;
  if (problem.zero && wanted != CaseConstraint::C2) {
    (*problem.zero == ResponsePart::TotalAngularMomentum ? total : base) = true;
  }
  if (total) {
    // Without a moment L = r x f is normal to f: two components say it all.
    const bool is_fixed = encounter.is_fixed();
    const Vector3d f = is_fixed ? Vector3d(encounter.stated.F.head<3>()) : encounter.n;
    const auto [u, v] = normals_of(f);
    rows.push_back({RowKind::Total, 0, u});
    rows.push_back({RowKind::Total, 1, v});
    const bool has_moment =
        is_fixed ? !encounter.stated.F.tail<3>().isZero(0) : !encounter.moment.isZero(0);
    if (has_moment) rows.push_back({RowKind::Total, 2, f.normalized()});
  }
  for (int i = 0; i < 3; ++i) {
    if (base) rows.push_back({RowKind::Base, i});
    if (coupling) {
      rows.push_back({total ? RowKind::CouplingAtZeroTotal : RowKind::Coupling, i});
    }
  }
  return rows;
}

}  // namespace stillbase::proof
