// What a problem cannot ask of a sticking contact or a latch, and why.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/plan/scenario.hpp>

#include "io/problem_reader.hpp"

namespace stillbase::io {

namespace {

/// Of a stated velocity: a part along the normal below this is rounding.
constexpr double kNoClosing = 1e-12;

}  // namespace

void check_rigid_contact(MapReader& map, const CaptureProblem& problem) {
  const ImpulseSpec& impulse = problem.impulse;
  if (impulse.contact == ContactLaw::Frictionless) return;
  const bool is_latch = impulse.contact == ContactLaw::Latch;
  const std::string law = word_of(kContactLawNames, impulse.contact);
  const auto refuse = [&](const char* section, const char* rule, const std::string& message) {
    map.context().add(map.line_of(section), rule,
                      fmt::format("{}.{}", map.path_of(section), message));
  };
  if (impulse.source == ImpulseSource::Given) {
    refuse("impact", "contradiction",
           fmt::format("contact: '{}' makes the impulse from the motion of a target; a given "
                       "impulse has none",
                       law));
  }
  if (is_latch && impulse.source == ImpulseSource::PointMass) {
    refuse("impact", "contradiction",
           "contact: 'latch' needs impact.source rigid_body; a point mass offers nothing to hold "
           "a moment against");
  }
  if (is_latch && problem.robot.hand_body == kBase) {
    refuse("impact", "not-supported",
           "contact: 'latch' needs a hand that moves relative to the base");
  }
  if (impulse.restitution != 0) {
    refuse("impact", "contradiction",
           fmt::format("restitution: is that of the contact 'normal'; without slip or with a "
                       "latch ('{}') it would create energy",
                       law));
  }
  if (problem.post_impact.contact.model == ContactModel::Compliant) {
    refuse("post_impact", "contradiction",
           fmt::format("contact: a spring-damper with Coulomb friction rebounds and slips, and "
                       "so is no contact '{}' as the search has it; use 'instantaneous'",
                       law));
  }
  const UncertaintySpec& spread = problem.uncertainty;
  const std::string no_direction = fmt::format(
      "the impulse of the contact '{}' follows from the whole relative velocity, and "
      "has no direction of its own to vary",
      law);
  if (spread.cone_half_angle > 0 || spread.cone_confidence) {
    refuse("uncertainty", "not-used", "cone_half_angle: " + no_direction);
  }
  if (spread.restitution > 0) {
    refuse("uncertainty", "not-used", fmt::format("restitution: the contact '{}' has none", law));
  }
  if (problem.measure.kind == RiskMeasure::WorstCase && !spread.residual_velocity) {
    refuse("objective", "not-supported",
           "measure: 'worst_case' is that over a cone of directions: " + no_direction +
               "; state uncertainty.residual_velocity, or use 'expectation' or 'cvar' over what "
               "is uncertain");
  }
  if (!is_latch) return;
  if (simulates_turn(problem)) {
    refuse("objective", "not-supported",
           "attitude_turned: is simulated with the robot alone; after a latch it holds the target");
  }
  if (problem.constraints.coupling_singular_value_min > 0) {
    refuse("constraints", "not-supported",
           "coupling_singular_value_min: is that of the robot alone; after a latch it holds the "
           "target");
  }
}

namespace {

/// The stated velocity of the target's point as the hand sees it, along the normal of every feature
/// that the plan may use: a sticking contact needs it positive, a latch not negative, and a path to
/// stop on zero.
void check_stated_closing(MapReader& map, const CaptureProblem& problem) {
  const HandMotionSpec& hand = problem.hand_motion;
  const VariableSpec& variables = problem.variables;
  const bool sticks = problem.impulse.contact == ContactLaw::Sticking;
  const auto refuse = [&](const char* rule, const std::string& message) {
    map.context().add(map.line_of("contact"), rule,
                      fmt::format("{}.hand_velocity{}", map.path_of("contact"), message));
  };
  if (!hand.linear) {
    if (sticks && hand.angular) {
      refuse("missing-key",
             ": leaves the linear velocity at a sticking contact open; state 'linear', closing in "
             "along the normal, or use impact.contact 'latch'");
    }
    return;
  }
  if (!problem.target) return;
  for (const ContactFeature& feature : problem.target->features) {
    const std::vector<std::string>& named = variables.features;
    const bool is_used = named.empty()
                             ? feature.name == variables.feature
                             : std::find(named.begin(), named.end(), feature.name) != named.end();
    if (!is_used) continue;
    const double closing = feature.normal.dot(*hand.linear);
    const bool is_along = std::abs(closing) > kNoClosing * hand.linear->norm();
    if (is_along && closing < 0) {
      refuse("separates",
             fmt::format(".linear: moves the target away from the hand along the normal of '{}', "
                         "at {:.4g} m/s; must close in{}",
                         feature.name, -closing, sticks ? "" : " or be zero"));
    } else if (sticks && !is_along) {
      refuse("contradiction",
             fmt::format(".linear: matches the target along the normal of '{}', so that nothing "
                         "pushes hand and target together; must close in, or use impact.contact "
                         "'latch'",
                         feature.name));
    } else if (is_along && problem.approach.enabled && problem.approach.abort) {
      refuse("contradiction",
             fmt::format(".linear: closes in along the normal of '{}' at {:.4g} m/s, so that no "
                         "path to stop on keeps hand and target apart; state {}.abort: false (the "
                         "default is true)",
                         feature.name, closing, map.path_of("approach")));
    }
  }
}

}  // namespace

void check_wheel_preset(MapReader& map, const CaptureProblem& problem) {
  if (problem.post_impact.wheels.preset.isZero(0)) return;
  const auto refuse = [&](const std::string& what) {
    map.context().add(map.line_of("post_impact"), "not-supported",
                      fmt::format("{}.wheels.preset: {}", map.path_of("post_impact"), what));
  };
  if (problem.hand_motion.moves()) {
    refuse(
        "momentum in the wheels turns the base on the run to the contact, which is planned "
        "without; leave it out, or contact.hand_velocity");
  } else if (problem.approach.enabled && problem.approach.base == BaseMode::Floating) {
    refuse(
        fmt::format("momentum in the wheels turns a floating base that the arm rotates, and the "
                    "approach is planned without; leave it out, or state {0}.base 'held' or "
                    "'reaction-null', which keep the attitude, or {0}.enabled: false",
                    map.path_of("approach")));
  }
}

std::string objection_to_nominal(const CaptureProblem& problem, ObjectiveQuantity quantity) {
  const HandMotionSpec& hand = problem.hand_motion;
  const auto is_zero = [](const std::optional<Vector3d>& part) { return part && part->isZero(0); };
  const bool matches_all =
      hand.velocity == HandVelocity::MatchAll ||
      (hand.velocity == HandVelocity::Stated && is_zero(hand.linear) && is_zero(hand.angular));
  if (!matches_all || quantity != ObjectiveQuantity::ImpulseMagnitude) return "";
  return "the impulse is zero in every posture with a contact.hand_velocity that matches all, "
         "stated zeros included; use a quantity of the motion after the contact, such as "
         "base_angular_momentum";
}

void check_hand_motion(MapReader& map, const CaptureProblem& problem) {
  const HandMotionSpec& hand = problem.hand_motion;
  if (!hand.moves()) {
    if (hand.rates != HandMotionSpec{}.rates) {
      map.context().add(map.line_of("contact"), "not-used",
                        fmt::format("{}.arrival_rates: a hand at rest has none; state "
                                    "hand_velocity",
                                    map.path_of("contact")));
    }
    return;
  }
  const ImpulseSpec& impulse = problem.impulse;
  const auto refuse = [&](const char* section, const char* rule, const std::string& message) {
    map.context().add(map.line_of(section), rule,
                      fmt::format("{}.{}", map.path_of(section), message));
  };
  const bool is_stated = hand.velocity == HandVelocity::Stated;
  if (impulse.source != ImpulseSource::RigidBody) {
    refuse("contact", "contradiction",
           "hand_velocity: follows a predicted rigid body (impact.source rigid_body); a point mass "
           "or a given impulse has no point whose motion is known");
    return;
  }
  if (impulse.contact == ContactLaw::Frictionless) {
    refuse("contact", "not-supported",
           "hand_velocity: needs impact.contact 'latch' or 'sticking'; a frictionless contact that "
           "is matched gives no impulse and holds nothing");
  }
  if (impulse.contact == ContactLaw::Sticking && !is_stated) {
    refuse("contact", "contradiction",
           "hand_velocity: points that move together along the normal exchange no impulse where "
           "nothing holds them; use impact.contact 'latch', or state a 'linear' that closes in");
  }
  if (is_stated && !hand.linear && !hand.angular) {
    refuse("contact", "missing-key", "hand_velocity: needs 'linear', 'angular' or both");
  }
  const int n = problem.robot.n();
  const auto size = [](const std::optional<Vector3d>& part) { return part ? 3 : 0; };
  const int matched = is_stated ? size(hand.linear) + size(hand.angular)
                      : hand.velocity == HandVelocity::MatchNormal ? 1
                      : hand.velocity == HandVelocity::MatchLinear ? 3
                                                                   : 6;
  if (matched > n) {
    refuse("contact", "too-many",
           fmt::format("hand_velocity: decides {} components of the hand's velocity with {} "
                       "joints; match at most as many",
                       matched, n));
  }
  if (is_stated) check_stated_closing(map, problem);
  const std::vector<bool>& free = problem.variables.joints;
  if (std::find(free.begin(), free.end(), false) != free.end()) {
    refuse("variables", "not-supported",
           "joints: with a contact.hand_velocity all joints move; must be 'all'");
  }
  if (problem.approach.enabled &&
      (problem.approach.base != BaseMode::Floating || !problem.approach.station_free)) {
    refuse("approach", "not-supported",
           "base: a contact.hand_velocity needs 'floating' with station_free: true; the robot has "
           "no momentum at the contact, and its base moves with the arm");
  }
  if (problem.measure.kind != RiskMeasure::Nominal && !problem.uncertainty.residual_velocity) {
    refuse("objective", "not-supported",
           "measure: with a contact.hand_velocity the joint rates are those of the nominal target, "
           "and what differs from it is a relative velocity; state uncertainty.residual_velocity, "
           "or use 'nominal'");
  }
  if (problem.measure.kind != RiskMeasure::Nominal) return;
  for (const ObjectiveTerm& term : problem.objective) {
    const std::string objection = objection_to_nominal(problem, term.quantity);
    if (!objection.empty()) refuse("objective", "contradiction", "quantity: " + objection);
  }
}

}  // namespace stillbase::io
