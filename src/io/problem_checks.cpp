// What the sections of a problem ask of each other.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/encounter/direction_cone.hpp>
#include <stillbase/encounter/left_out.hpp>
#include <stillbase/encounter/residual_velocity.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/plan/feature.hpp>
#include <stillbase/plan/scenario.hpp>
#include <stillbase/simulation/contact.hpp>

#include "io/problem_reader.hpp"

namespace stillbase::io {

namespace {

/// The attitude change of the base is simulated for every posture that the search evaluates.
void check_attitude_change(MapReader& map, const CaptureProblem& problem) {
  const auto term =
      std::find_if(problem.objective.begin(), problem.objective.end(),
                   [](const ObjectiveTerm& t) { return row_of(t.quantity).is_simulated(); });
  if (term == problem.objective.end()) return;
  const auto refuse = [&](const char* rule, const std::string& what) {
    map.context().add(map.line_of("objective"), rule,
                      fmt::format("{}: attitude_turned {}", map.path_of("objective"), what));
  };
  const PostImpactSpec& spec = problem.post_impact;
  if (spec.controllers.empty()) {
    refuse("missing-key", "needs post_impact.controllers: the first one acts after the impact");
  }
  if (term->after > spec.horizon) {
    refuse("out-of-range",
           fmt::format("after: {} s lie beyond post_impact.horizon = {} s, up to which the time "
                       "after the impact is judged",
                       term->after, spec.horizon));
  }
  if (spec.contact.model != ContactModel::Instantaneous) {
    refuse("not-supported",
           "is that after the instantaneous impact: post_impact.contact must be 'instantaneous'");
  }
}

/// A robust measure needs something to be robust against: asked once the cone is known.
void check_measure(MapReader& map, const CaptureProblem& problem) {
  const auto refuse = [&](const std::string& what) {
    map.context().add(map.line_of("objective"), "missing-key",
                      fmt::format("{}.measure: {}", map.path_of("objective"), what));
  };
  const UncertaintySpec& spread = problem.uncertainty;
  if (spread.residual_velocity) return;
  if (problem.measure.kind == RiskMeasure::WorstCase && !(spread.cone_half_angle > 0)) {
    refuse("'worst_case' needs uncertainty.cone_half_angle > 0, or uncertainty.residual_velocity");
  }
  const bool sampled =
      problem.measure.kind == RiskMeasure::Expectation || problem.measure.kind == RiskMeasure::Cvar;
  const JointVectord& joints = spread.joint_position;
  const double widest =
      std::max({joints.size() > 0 ? joints.maxCoeff() : 0, spread.cone_half_angle,
                spread.closing_speed, spread.restitution, spread.target_mass, spread.target_inertia,
                spread.contact_point, spread.contact_time});
  if (sampled && !(widest > 0)) refuse("needs something uncertain in the section 'uncertainty'");
  const double tail = (1 - problem.measure.cvar_level) * problem.measure.samples;
  if (problem.measure.kind == RiskMeasure::Cvar && !(tail >= 2 - 1e-9)) {
    map.context().add(
        map.line_of("objective"), "out-of-range",
        fmt::format("{}.samples: {} samples leave {:.3g} of them in the tail that counts; at least "
                    "2 are needed, or a single one decides",
                    map.path_of("objective"), problem.measure.samples, tail));
  }
}

/// Line of a key of a section, or of the section where the key is absent or further inside.
int line_of(MapReader& map, const std::string& section, const std::string& key) {
  const Node* const node = map.find(section);
  const Node* const value = node != nullptr ? node->find(key) : nullptr;
  return value != nullptr ? value->line : map.line_of(section);
}

/// What stands beside a residual velocity, and whether it can be predicted.
void check_residual(MapReader& map, const CaptureProblem& problem) {
  const UncertaintySpec& spread = problem.uncertainty;
  if (!spread.residual_velocity) return;
  const std::size_t before = map.context().findings.size();
  const auto refuse = [&map](const char* section, const char* rule, const std::string& what) {
    map.context().add(map.line_of(section), rule, fmt::format("{}.{}", map.path_of(section), what));
  };
  const ImpulseSpec& impulse = problem.impulse;
  if (impulse.direction || impulse.source == ImpulseSource::Given || !problem.target ||
      problem.variables.feature.empty()) {
    refuse("uncertainty", "not-used",
           "residual_velocity: needs an impulse that follows from the motion of a target with a "
           "contact feature; state the target's state in place of impact.direction");
  }
  if (!spread.residual_velocity->covariance && !problem.target_deviations) {
    refuse("uncertainty", "missing-key",
           "residual_velocity: 'from_covariance' needs target.state.covariance");
  }
  if (spread.cone_half_angle > 0 || spread.cone_confidence) {
    refuse("uncertainty", "contradiction",
           "residual_velocity: a worst case is that over the velocity or over a cone of "
           "directions; leave residual_velocity or cone_half_angle out");
  }
  if (spread.closing_speed > 0) {
    map.context().add(line_of(map, "uncertainty", "closing_speed"), "contradiction",
                      fmt::format("{}.closing_speed: is a part of residual_velocity, and would "
                                  "count twice; leave one of them out",
                                  map.path_of("uncertainty")));
  }
  if (problem.measure.kind == RiskMeasure::Cvar) {
    refuse("objective", "not-supported",
           "measure: 'cvar' has no closed form over uncertainty.residual_velocity; use "
           "'expectation' or 'worst_case'");
  }
  if (simulates_turn(problem)) {
    refuse("objective", "not-supported",
           "attitude_turned: is not linear in the impulse, as the measures over "
           "uncertainty.residual_velocity need it");
  }
  if (map.context().findings.size() > before) return;
  try {
    static_cast<void>(ResidualRoot(problem));
  } catch (const std::invalid_argument& error) {
    refuse("uncertainty", "out-of-range", std::string("residual_velocity: ") + error.what());
  }
}

/// The motion of the target is computed before the search, in time with its rotation.
void check_rotation(MapReader& map, const CaptureProblem& problem) {
  if (!problem.target || problem.target->is_point_mass || problem.impulse.direction) return;
  const TargetState& state = problem.target_state;
  const Matrix3d& I = problem.target->inertia;
  const Vector3d w = state.pose.orientation.conjugate() * state.angular_velocity;
  // The energy bounds the rate: I_min |omega|^2 <= omega' I omega.
  const double rate = std::sqrt(w.dot(I * w) / principal_moments(I)[0]);
  const double horizon = motion_horizon(problem);
  if (rate * horizon <= kMostRotation) return;
  map.context().add(map.line_of("target"), "out-of-range",
                    fmt::format("{}.state.angular_velocity: the target rotates by up to {:.4g} rad "
                                "within the {:.4g} s around its estimate that wait, motion and "
                                "contact time need; must be <= {} rad",
                                map.path_of("target"), rate * horizon, horizon, kMostRotation));
}

/// The margin leaves a part of each joint's range.
void check_margin(MapReader& map, const CaptureProblem& problem) {
  const double margin = problem.constraints.joint_limit_margin;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[static_cast<std::size_t>(k)];
    if (joint.type == JointType::Continuous || margin == 0) continue;
    if (joint.lower + margin <= joint.upper - margin) continue;
    map.context().add(
        map.line_of("constraints"), "out-of-range",
        fmt::format("{}.joint_limit_margin: {} {} leaves nothing of the range [{}, "
                    "{}] of {}; must be <= {}",
                    map.path_of("constraints"), margin, joint.is_prismatic() ? "m" : "rad",
                    joint.lower, joint.upper, joint.name, (joint.upper - joint.lower) / 2));
  }
}

void check_problem(MapReader& map, const CaptureProblem& problem) {
  ReadContext& context = map.context();
  const ImpulseSpec& impulse = problem.impulse;
  const bool has_feature = problem.target && !problem.variables.feature.empty();
  const auto refuse = [&](const char* section, const char* rule, const std::string& message) {
    context.add(map.line_of(section), rule, fmt::format("{}.{}", map.path_of(section), message));
  };

  if (!impulse.direction && !has_feature) {
    refuse("impact", "missing-key",
           "direction: must be stated when there is no target with a contact feature");
  }
  if (impulse.source == ImpulseSource::RigidBody &&
      (!has_feature || problem.target->is_point_mass)) {
    refuse("impact", "missing-key",
           "source: 'rigid_body' needs a target that is a rigid body with a contact feature");
  }
  if (impulse.source == ImpulseSource::RigidBody && impulse.direction) {
    refuse("impact", "not-used",
           "direction: 'rigid_body' takes it from the contact feature; leave it out");
  }
  if (impulse.source != ImpulseSource::Given && !impulse.moment.isZero(0)) {
    refuse("impact", "not-used", "moment: only a given impulse has a moment");
  }
  if (impulse.source != ImpulseSource::Given && impulse.magnitude != ImpulseSpec{}.magnitude) {
    refuse("impact", "not-used", "magnitude: only a given impulse has one; here it follows");
  }
  if (impulse.source == ImpulseSource::PointMass && impulse.direction &&
      !(impulse.closing_speed >= problem.constraints.closing_speed_min)) {
    refuse("impact", "out-of-range",
           fmt::format("closing_speed: is {} m/s; a point mass from a stated direction needs at "
                       "least closing_speed_min = {} m/s",
                       impulse.closing_speed, problem.constraints.closing_speed_min));
  }
  if (!impulse.direction && impulse.closing_speed != 0) {
    refuse("impact", "not-used",
           "closing_speed: is stated only beside a direction; here the motion of the target "
           "decides");
  }
  const Node* target = map.child("target");
  const bool states_motion = target != nullptr && MapReader(context, *target, "").has("state");
  if (impulse.direction && states_motion) {
    refuse("target", "not-used",
           "state: with impact.direction stated the target comes along it at closing_speed; leave "
           "one of them out");
  }
  if (!impulse.direction && problem.target && !states_motion) {
    refuse("target", "missing-key",
           "state: must be stated when impact.direction is not, or nothing says how it moves");
  }

  const HandSpec& hand = problem.hand;
  if (hand.constraint == HandConstraint::Position && !hand.position && impulse.direction) {
    refuse("hand", "missing-key",
           "position: must be stated beside impact.direction; the target comes to the hand then");
  }
  const VariableSpec& variables = problem.variables;
  const bool is_placed =
      hand.constraint != HandConstraint::None || variables.base_position != PositionFreedom::Fixed;
  if (hand.position && !impulse.direction) {
    refuse("hand", "not-used",
           "position: the hand reaches the contact feature, wherever that is; a stated position "
           "belongs to a stated impact.direction");
  } else if (hand.position && !is_placed) {
    refuse("hand", "not-used",
           "position: without a constraint on the hand it takes a free base_position to get there");
  } else if (hand.position && hand.frame == Frame::Base &&
             variables.base_position != PositionFreedom::Fixed) {
    refuse("variables", "not-used",
           "base_position: nothing depends on it while the hand's position is stated in the base");
  }
  if (!hand.position && !impulse.direction && has_feature && !is_placed) {
    refuse("hand", "missing-key",
           "constraint: with the base_position fixed nothing brings the hand to the contact "
           "feature; state 'position', 'axis' or 'pose', or free the base_position");
  }
  if (impulse.direction && variables.contact_time_upper > variables.contact_time_lower) {
    refuse("variables", "not-used",
           "contact_time: beside a stated impact.direction the target comes along it at any time; "
           "state an instant");
  }
  if (hand.orientation && hand.constraint != HandConstraint::Pose) {
    refuse("hand", "not-used", "orientation: only the constraint 'pose' uses it");
  }

  if (problem.uncertainty.cone_confidence && !problem.variables.features.empty()) {
    refuse("uncertainty", "not-supported",
           "cone_half_angle: 'from_covariance' belongs to one contact feature; state the angle "
           "beside a choice of features");
  } else if (problem.uncertainty.cone_confidence && (impulse.direction || !has_feature)) {
    refuse("uncertainty", "missing-key",
           "cone_half_angle: 'from_covariance' needs a direction that follows from the contact "
           "feature of a target");
  } else if (problem.uncertainty.cone_confidence && !problem.target_deviations) {
    refuse("uncertainty", "missing-key",
           "cone_half_angle: 'from_covariance' needs target.state.covariance");
  }
  if (problem.target && problem.target->is_point_mass && problem.target_deviations &&
      !problem.target_deviations->moments.isZero(0)) {
    refuse("target", "not-used", "state.covariance.moments: a point mass has none");
  }

  if (impulse.contact != ContactLaw::Latch &&
      problem.post_impact.model.target_mass_scale != ControllerModelSpec{}.target_mass_scale) {
    refuse("post_impact", "not-used",
           "model.target_mass_scale: the controllers know of a target only where impact.contact "
           "latch holds it");
  }
  if (impulse.contact != ContactLaw::Latch && problem.post_impact.grip.is_limited()) {
    refuse("post_impact", "not-used",
           "grip: limits of a grip need a target that is held, impact.contact latch");
  }
  const std::vector<std::string>& controllers = problem.post_impact.controllers;
  if (!problem.post_impact.wheels.exist() &&
      std::find(controllers.begin(), controllers.end(), to_string(ControllerKind::Detumble)) !=
          controllers.end()) {
    refuse("post_impact", "missing-key",
           "controllers: 'detumble' takes the momentum with wheels; state post_impact.wheels");
  }
  const ContactModel contact = problem.post_impact.contact.model;
  if (contact == ContactModel::Compliant &&
      (!problem.target || impulse.source == ImpulseSource::Given)) {
    refuse("post_impact", "missing-key",
           "contact: this model needs a target and a contact law, impact.source point_mass or "
           "rigid_body");
  }
  if (contact == ContactModel::Compliant && impulse.source == ImpulseSource::PointMass) {
    refuse("post_impact", "not-supported",
           "contact: a compliant contact needs a rigid body; a point mass that slides along the "
           "hand would have to take a moment");
  }
  if (contact == ContactModel::Compliant && problem.resistance.model == ResistanceModel::Locked) {
    refuse("post_impact", "not-supported",
           "contact: a compliant contact takes time, in which locked joints mean nothing; use "
           "joint_resistance servo");
  }
  if (contact == ContactModel::Compliant && impulse.contact == ContactLaw::Frictionless &&
      !problem.post_impact.contact.damping && !(impulse.restitution >= kLeastRestitution)) {
    refuse("post_impact", "out-of-range",
           fmt::format("contact: a spring-damper always leaves some restitution: "
                       "impact.restitution must be at least {}, or damping stated",
                       kLeastRestitution));
  }

  const auto& plane = problem.uncertainty.cone_plane_normal;
  if (plane && impulse.direction && impulse.direction_frame == Frame::Base &&
      !(std::abs(plane->dot(*impulse.direction)) <= 1e-9)) {
    refuse("uncertainty", "out-of-range",
           "cone_plane: the direction of the impulse does not lie in this plane");
  }
  const UncertaintySpec& spread = problem.uncertainty;
  if (impulse.restitution - spread.restitution < 0 ||
      impulse.restitution + spread.restitution > 1) {
    refuse("uncertainty", "out-of-range",
           fmt::format("restitution: {} about impact.restitution {} leaves [0, 1]",
                       spread.restitution, impulse.restitution));
  }
}

constexpr double kParallel = 1e-9;

bool is_parallel(const Vector3d& a, const Vector3d& unit) {
  return a.cross(unit).norm() <= kParallel * (1 + a.norm());
}

/// What leaves the plane with this normal (in B); empty: nothing.
std::string out_of_plane(const CaptureProblem& problem, const Vector3d& normal) {
  // The axis of a joint stays parallel to the normal whatever the joints before it do.
  std::vector<Matrix3d> axes;
  for (const Joint& joint : problem.robot.tree()) {
    const Matrix3d R =
        joint.parent == kBase
            ? joint.R.matrix()
            : Matrix3d(axes[static_cast<std::size_t>(joint.parent)] * joint.R.matrix());
    axes.push_back(R);
    const Vector3d z = R.col(2);
    const bool stays =
        joint.is_prismatic() ? std::abs(z.dot(normal)) <= kParallel : is_parallel(z, normal);
    if (!stays) return fmt::format("joint {} moves the arm out of it", joint.name);
  }
  const Vector3d normal_N = problem.base.orientation * normal;
  const VariableSpec& variables = problem.variables;
  if (variables.base_attitude == AttitudeFreedom::Axis) {
    if (!is_parallel(variables.base_attitude_axis, normal_N)) {
      return "the base may rotate out of it";
    }
  } else if (variables.base_attitude != AttitudeFreedom::Fixed) {
    return "the base may rotate out of it";
  }
  if (problem.impulse.direction) {
    const bool in_N = problem.impulse.direction_frame == Frame::Inertial;
    if (!(std::abs(problem.impulse.direction->dot(in_N ? normal_N : normal)) <= kParallel)) {
      return "the impulse points out of it";
    }
    return "";
  }
  const TargetState& state = problem.target_state;
  const Vector3d n = state.pose.orientation * chosen_feature(problem).normal;
  if (!(std::abs(n.dot(normal_N)) <= kParallel))
    return "the normal of the contact feature points out of it";
  if (!is_parallel(state.angular_velocity, normal_N)) return "the target rotates out of it";
  const Matrix3d& I = problem.target->inertia;
  const Vector3d in_T = state.pose.orientation.conjugate() * normal_N;
  if (!problem.target->is_point_mass && !is_parallel(I * in_T / I.trace(), in_T)) {
    return "the target does not keep rotating in it: it is no plane of symmetry of its inertia";
  }
  return "";
}

/// Which error of the estimate tilts the contact's normal out of the plane; empty: none.
std::string tilts(const CaptureProblem& problem, const Vector3d& normal_N) {
  const EstimateDeviations& deviations = *problem.target_deviations;
  const Vector3d in_T = problem.target_state.pose.orientation.conjugate() * normal_N;
  for (int i = 0; i < 3; ++i) {
    if (deviations.orientation[i] > 0 && !is_parallel(Vector3d::Unit(i), in_T)) {
      return "orientation";
    }
    if (deviations.angular_velocity[i] > 0 && !is_parallel(Vector3d::Unit(i), normal_N)) {
      return "angular_velocity";
    }
  }
  return "";
}

/// A wedge (cone_plane) stands for all directions only where everything stays in its plane. Finds
/// what leaves it: arm, base, impulse, target, or an error of the target's estimate.
/// @pre the problem's sections are good and fit together
void check_wedge(MapReader& map, const CaptureProblem& problem) {
  const UncertaintySpec& uncertainty = problem.uncertainty;
  if (!uncertainty.cone_plane_normal) return;
  const auto refuse = [&](const std::string& message) {
    map.context().add(map.line_of("uncertainty"), "not-planar",
                      fmt::format("{}.cone_plane: {}", map.path_of("uncertainty"), message));
  };
  const Vector3d& normal = *uncertainty.cone_plane_normal;
  const std::string what = out_of_plane(problem, normal);
  if (!what.empty()) {
    return refuse(
        "the worst direction of a problem that is not planar need not lie in the wedge (" + what +
        "); leave it out");
  }
  if (!uncertainty.cone_confidence) return;
  const std::string error = tilts(problem, problem.base.orientation * normal);
  if (!error.empty()) {
    refuse(
        fmt::format("target.state.covariance.{} tilts the normal out of this plane; state the "
                    "deviations in the plane, or leave cone_plane out",
                    error));
  }
}

/// Remarks on a cone that leaves the plane of a planar problem: most of its directions are none
/// that the problem knows.
void look_at_cone(MapReader& map, const CaptureProblem& problem) {
  const UncertaintySpec& uncertainty = problem.uncertainty;
  const bool is_cone = uncertainty.cone_half_angle > 0 && !uncertainty.cone_plane_normal;
  const auto& joints = problem.robot.joints;
  const auto turning = std::find_if(joints.begin(), joints.end(),
                                    [](const Joint& joint) { return !joint.is_prismatic(); });
  if (!is_cone || turning == joints.end() || turning->parent != kBase) return;
  const Vector3d normal = turning->R.matrix().col(2);
  if (!out_of_plane(problem, normal).empty()) return;
  map.context().remarks.push_back(
      {map.context().source, map.line_of("uncertainty"), "planar",
       fmt::format("{}.cone_plane: robot, impulse and target stay in a plane, but the directions "
                   "of the cone leave it; state the plane with normal [{:.6g}, {:.6g}, {:.6g}]",
                   map.path_of("uncertainty"), normal.x(), normal.y(), normal.z())});
}

/// Puts the half-angle in place that follows from the covariance of the estimate.
void resolve_cone(MapReader& map, CaptureProblem& problem) {
  UncertaintySpec& uncertainty = problem.uncertainty;
  if (!uncertainty.cone_confidence) return;
  const auto refuse = [&](const std::string& what) {
    map.context().add(map.line_of("uncertainty"), "out-of-range",
                      fmt::format("{}.cone_half_angle: {}", map.path_of("uncertainty"), what));
  };
  try {
    uncertainty.cone_half_angle = direction_cone(problem, *uncertainty.cone_confidence).half_angle;
  } catch (const std::invalid_argument& error) {
    return refuse(error.what());
  }
  if (!(uncertainty.cone_half_angle <= kPi / 2)) {
    refuse(
        fmt::format("the covariance gives {:.4g} rad; must be at most pi/2, or the target may "
                    "come from anywhere",
                    uncertainty.cone_half_angle));
  }
}

}  // namespace

void check_sections(MapReader& map, CaptureProblem& problem) {
  const std::vector<Finding>& findings = map.context().findings;
  check_problem(map, problem);
  check_rigid_contact(map, problem);
  check_wheel_preset(map, problem);
  check_hand_motion(map, problem);
  check_margin(map, problem);
  check_rotation(map, problem);
  if (findings.empty()) check_wedge(map, problem);
  if (findings.empty()) resolve_cone(map, problem);
  if (findings.empty()) check_residual(map, problem);
  if (problem.uncertainty.cone_confidence && !findings.empty()) return;
  const std::size_t before = findings.size();
  check_attitude_change(map, problem);
  if (findings.size() == before) check_measure(map, problem);
  if (findings.empty()) look_at_cone(map, problem);
  if (!findings.empty()) return;
  for (const LeftOut& one : left_out(problem)) {
    map.context().remarks.push_back(
        {map.context().source, line_of(map, one.section, one.key), one.code,
         fmt::format("{}.{}: {}", map.path_of(one.section), one.key, one.message)});
  }
}

}  // namespace stillbase::io
