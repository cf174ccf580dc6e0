// Is the configuration one that the problem allows, with the hand where the contact is?
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"

namespace stillbase::verification {
namespace {

// What the problem fixes may differ by rounding only.
constexpr double kFixed = 1e-9;

void check_joints(const Context& context, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const JointVectord& phi = context.plan.configuration.phi;
  double beyond = -kInfinity, moved = 0;
  std::string worst = "no limits";
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    const double margin = problem.constraints.joint_limit_margin;
    for (const double excess : {joint.lower + margin - phi(k), phi(k) - joint.upper + margin}) {
      if (excess > beyond) {
        beyond = excess;
        worst = joint.name;
      }
    }
    if (!problem.variables.joints[k]) moved = std::max(moved, std::abs(phi(k) - problem.start(k)));
  }
  // Without any limit nothing is beyond: say zero instead of minus infinity.
  claims.at_most("joint_limits", std::isfinite(beyond) ? beyond : 0.0, kFixed, "rad",
                 fmt::format("furthest beyond a joint limit with its margin: {}", worst));
  claims.at_most("fixed_joints", moved, kFixed, "rad",
                 "joints that the problem does not free stay at the start posture");
}

void check_base(const Context& context, ClaimList& claims) {
  const VariableSpec& free = context.problem.variables;
  const Pose& stated = context.problem.base;
  const Pose& base = context.plan.configuration.base;

  const ApproachSpec& approach = context.problem.approach;
  const bool follows =
      approach.enabled && approach.base == BaseMode::Floating && !approach.station_free;

  // Turn from the stated attitude, in N; its part off the allowed axis and its size.
  const Vector3d turn = rotation_log(base.orientation * stated.orientation.conjugate());
  // Squares: what the search is held to is the square of the turn.
  const double most = free.base_attitude_max;
  double excess = std::max(0.0, turn.squaredNorm() - most * most);
  std::string rule = "free up to a largest turn (squares compared)";
  if (follows) {
    excess = 0;
    rule = "follows from the path: see approach_base_arrival";
  } else if (free.base_attitude == AttitudeFreedom::Fixed) {
    excess = pose_error(base, stated).angle;
    rule = "stays as stated";
  } else if (free.base_attitude == AttitudeFreedom::Axis) {
    const Vector3d off = turn - turn.dot(free.base_attitude_axis) * free.base_attitude_axis;
    excess = std::max(excess, off.norm());
    rule = "turns about the stated axis up to a largest turn";
  } else if (free.base_attitude == AttitudeFreedom::Cone) {
    // By the cosine, as the constraint is kept.
    const Vector3d axis =
        base.orientation * (stated.orientation.conjugate() * Vector3d(free.base_attitude_axis));
    excess = std::max(0.0, std::cos(free.base_attitude_max) - axis.dot(free.base_attitude_axis));
    rule = "its axis stays within the cone about the stated direction";
  }
  claims.at_most("base_attitude", excess, kFixed, "rad", rule);

  double beyond = 0;
  rule = "free";
  if (follows) {
    rule = "follows from the path: see approach_base_arrival";
  } else if (free.base_position == PositionFreedom::Fixed) {
    beyond = (base.position - stated.position).norm();
    rule = "stays as stated";
  } else if (free.base_position == PositionFreedom::Box) {
    beyond = std::max(0.0, std::max((free.base_position_lower - base.position).maxCoeff(),
                                    (base.position - free.base_position_upper).maxCoeff()));
    rule = "stays in its box";
  }
  claims.at_most("base_position", beyond, kFixed, "m", rule);

  const double time = context.plan.configuration.contact_time;
  claims.at_most(
      "contact_time",
      std::max({0.0, free.contact_time_lower - time, time - free.contact_time_upper}), kFixed, "s",
      fmt::format("within [{}, {}] s", free.contact_time_lower, free.contact_time_upper));
}

void check_hand(const Context& context, const ContactEvent& event, const PostureResponse& response,
                ClaimList& claims) {
  const HandSpec& hand = context.problem.hand;
  const Pose& base = context.plan.configuration.base;
  const VerifyOptions& options = context.options;
  const bool in_base = hand.frame == Frame::Base;
  const double tolerance = options.hand_position_tolerance;

  const Vector3d position = base * Vector3d(response.dynamics.hand_position);
  const bool is_free = hand.constraint == HandConstraint::None &&
                       context.problem.variables.base_position == PositionFreedom::Fixed;
  if (hand.position && !is_free) {
    const Vector3d wanted = in_base ? base * *hand.position : *hand.position;
    claims.at_most("hand_position", (position - wanted).norm(), tolerance, "m",
                   "hand from its stated point");
  } else if (event.feature) {
    claims.at_most("hand_position", (position - event.feature->point).norm(), tolerance, "m",
                   "hand from the contact feature at the contact time");
  }

  const Eigen::Quaterniond R_NH =
      base.orientation * Eigen::Quaterniond(Matrix3d(response.dynamics.hand_rotation));
  if (const auto wanted = wanted_hand_axes(context.problem, event, context.plan.configuration)) {
    claims.at_most("hand_orientation", pose_error({{}, R_NH}, {{}, *wanted}).angle,
                   options.hand_angle_tolerance, "rad",
                   "hand axes from their directions, roll about the normal included");
  }
  const bool wants_axis =
      hand.constraint == HandConstraint::Axis || hand.constraint == HandConstraint::Pose;
  if (wants_axis && !hand.orientation) {
    claims.at_most("hand_axis",
                   angle_between(R_NH * hand.approach_axis, base.orientation * Vector3d(-event.n)),
                   options.hand_angle_tolerance, "rad",
                   event.feature ? "approach axis from the inward normal of the contact feature"
                                 : "approach axis from the opposite of the stated direction");
  }
}

}  // namespace

void check_configuration(const Context& context, const ContactEvent& event,
                         const PostureResponse& response, ClaimList& claims) {
  check_joints(context, claims);
  check_base(context, claims);
  check_hand(context, event, response, claims);

  const CaptureProblem& problem = context.problem;
  const double v_n = closing_speed(problem, event, event.n);
  claims.same("closing_speed",
              relative_error(context.plan.impact.closing_speed, v_n,
                             event.velocity ? event.velocity->norm() : 0),
              context.options.recompute_tolerance,
              fmt::format("{:.6g} m/s along the direction of the impulse", v_n));
  if (problem.impulse.source != ImpulseSource::Given) {
    claims.at_least("closing_speed_min", v_n, problem.constraints.closing_speed_min, kFixed, "m/s",
                    "how fast target and hand close");
  }
}

}  // namespace stillbase::verification
