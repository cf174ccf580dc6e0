// Is the configuration one that the problem allows, with the hand at the contact?
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/margins.hpp"
#include "verification/tolerances.hpp"

namespace stillbase::verification {
namespace {

void check_joints(const Situation& situation, ClaimList& claims) {
  const CaptureProblem& problem = situation.problem;
  const JointVectord& phi = situation.at.phi;
  Largest beyond{-kInfinity, "no limits"};
  double moved = 0;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    const double margin = problem.constraints.joint_limit_margin;
    beyond.take(joint.lower + margin - phi(k), joint.name);
    beyond.take(phi(k) - joint.upper + margin, joint.name);
    if (!problem.variables.joints[k]) moved = std::max(moved, std::abs(phi(k) - problem.start(k)));
  }
  // Without any limit the value is zero instead of minus infinity.
  claims.at_most("joint_limits", std::isfinite(beyond.value) ? beyond.value : 0.0, kShared.rounding,
                 "rad", "furthest beyond a joint limit with its margin: " + beyond.place);
  claims.at_most("fixed_joints", moved, kShared.rounding, "rad",
                 "joints that are no variables stay at the start posture");
}

/// A size, and the rule that it is measured against.
struct Excess {
  double value = 0;
  const char* rule = "";
};

constexpr const char* kFollows = "follows from the path: see approach_base_arrival";

Excess attitude_excess(const CaptureProblem& problem, const Pose& base) {
  const VariableSpec& free = problem.variables;
  // Rotation vector from the stated attitude, in N.
  const Eigen::Quaterniond change = base.orientation * problem.base.orientation.conjugate();
  const Vector3d vector = rotation_log(change);
  const Vector3d& axis = free.base_attitude_axis;
  // Squares: the search constrains the square of the rotation angle.
  const double largest = free.base_attitude_max;
  const double beyond = std::max(0.0, vector.squaredNorm() - largest * largest);
  switch (free.base_attitude) {
    case AttitudeFreedom::Fixed:
      return {pose_error(base, problem.base).angle, "stays as stated"};
    case AttitudeFreedom::Axis:
      return {std::max(beyond, (vector - vector.dot(axis) * axis).norm()),
              "rotates about the stated axis up to a largest angle"};
    case AttitudeFreedom::Cone:
      // By the cosine, as the search constrains it.
      return {std::max(0.0, std::cos(largest) - axis.dot(change * axis)),
              "its axis stays within the cone about the stated direction"};
    case AttitudeFreedom::Free:
      break;
  }
  return {beyond, "free up to a largest rotation angle (squares compared)"};
}

Excess position_excess(const CaptureProblem& problem, const Pose& base) {
  const VariableSpec& free = problem.variables;
  switch (free.base_position) {
    case PositionFreedom::Fixed:
      return {(base.position - problem.base.position).norm(), "stays as stated"};
    case PositionFreedom::Box:
      return {std::max({0.0, (free.base_position_lower - base.position).maxCoeff(),
                        (base.position - free.base_position_upper).maxCoeff()}),
              "stays in its box"};
    case PositionFreedom::Free:
      break;
  }
  return {0, "free"};
}

void check_base(const Situation& situation, ClaimList& claims) {
  const CaptureProblem& problem = situation.problem;
  const ApproachSpec& approach = problem.approach;
  const bool follows =
      approach.enabled && approach.base == BaseMode::Floating && !approach.station_free;
  const Pose& base = situation.at.base;
  const Excess attitude = follows ? Excess{0, kFollows} : attitude_excess(problem, base);
  claims.at_most("base_attitude", attitude.value, kShared.rounding, "rad", attitude.rule);
  const Excess position = follows ? Excess{0, kFollows} : position_excess(problem, base);
  claims.at_most("base_position", position.value, kShared.rounding, "m", position.rule);

  const double time = situation.at.contact_time, earliest = problem.variables.contact_time_lower,
               latest = problem.variables.contact_time_upper;
  claims.at_most("contact_time", std::max({0.0, earliest - time, time - latest}), kShared.rounding,
                 "s", fmt::format("within [{}, {}] s", earliest, latest));
}

void check_hand(const Situation& situation, const VerifyOptions& options, ClaimList& claims) {
  const HandSpec& hand = situation.problem.hand;
  const Pose& base = situation.at.base;
  const bool is_free = hand.constraint == HandConstraint::None &&
                       situation.problem.variables.base_position == PositionFreedom::Fixed;
  if (hand.position && !is_free) {
    const Vector3d wanted = hand.frame == Frame::Base ? base * *hand.position : *hand.position;
    claims.at_most("hand_position", (situation.hand_N - wanted).norm(),
                   options.hand_position_tolerance, "m", "hand from its stated point");
  } else if (situation.event.feature) {
    claims.at_most("hand_position", (situation.hand_N - situation.event.feature->point).norm(),
                   options.hand_position_tolerance, "m",
                   "hand from the contact feature at the contact time");
  }

  if (const auto wanted = demanded_hand_axes(situation.problem, situation.event, situation.at)) {
    claims.at_most("hand_orientation", pose_error({{}, situation.R_NH}, {{}, *wanted}).angle,
                   options.hand_angle_tolerance, "rad",
                   "hand axes from their directions, roll about the normal included");
  }
  const bool wants_axis =
      hand.constraint == HandConstraint::Axis || hand.constraint == HandConstraint::Pose;
  if (wants_axis && !hand.orientation) {
    claims.at_most("hand_axis",
                   angle_between(situation.R_NH * hand.approach_axis,
                                 base.orientation * Vector3d(-situation.event.n)),
                   options.hand_angle_tolerance, "rad",
                   situation.event.feature
                       ? "approach axis from the inward normal of the contact feature"
                       : "approach axis from the opposite of the stated direction");
  }
}

}  // namespace

void check_configuration(const Situation& situation, const VerifyOptions& options,
                         ClaimList& claims) {
  check_joints(situation, claims);
  check_base(situation, claims);
  check_hand(situation, options, claims);
  if (situation.problem.impulse.source != ImpulseSource::Given) {
    claims.at_least("closing_speed_min",
                    closing_speed(situation.problem, situation.event, situation.event.n),
                    situation.problem.constraints.closing_speed_min, kShared.rounding, "m/s",
                    "closing speed of target and hand");
  }
}

std::vector<std::string> configuration_objections(const Situation& situation,
                                                  const VerifyOptions& options) {
  ClaimList claims;
  check_configuration(situation, options, claims);
  check_margins(situation, options, claims);
  std::vector<std::string> out;
  for (const Claim& claim : claims.claims()) {
    if (!claim.pass) out.push_back(claim.name);
  }
  const Vector6d unit = case_wrench(situation.problem, situation.event, situation.response);
  const double off_case = case_residuals(situation.problem, situation.response, unit).wanted;
  if (!(off_case <= options.constraint_tolerance)) out.push_back("case");
  return out;
}

}  // namespace stillbase::verification
