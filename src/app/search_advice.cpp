#include "app/search_advice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/plan/feature.hpp>
#include <stillbase/search/search.hpp>

#include "app/window_words.hpp"
#include "app/words.hpp"
#include "approach/pace.hpp"
#include "plan/contact_limits.hpp"

namespace stillbase::app {

namespace {

/// How far constraints of a kind are violated, the most violated one, relative to its bound.
double violation_of(const Plan& plan, const ContactLimitRow* row) {
  double worst = 0;
  for (const ConstraintValue& constraint : plan.constraints) {
    if (!(constraint.violation > kFeasibilityTolerance)) continue;
    if (row != limit_of(plan.problem, constraint.name)) continue;
    const double bound = constraint.value > constraint.upper ? constraint.upper : constraint.lower;
    worst = std::max(worst, constraint.violation / std::max(std::abs(bound), 1e-9));
  }
  return worst;
}

/// Those of the constraints that the nearest attempt violates, the most violated one of a kind
/// deciding on the order.
std::vector<std::string> loosening_advice(const Plan& plan) {
  std::vector<std::pair<double, std::string>> found;
  for (const ContactLimitRow& row : contact_limits()) {
    const double worst = violation_of(plan, &row);
    if (worst > 0) found.emplace_back(-worst, row.loosening);
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> out;
  out.reserve(found.size());
  for (auto& [order, advice] : found) out.push_back(std::move(advice));
  return out;
}

/// "approach.velocity_scale of 0.98, now 0.115 (...)": the change of the limits that make the
/// motion slow; empty: none helps.
std::string faster_words(const CaptureProblem& problem, const Pace& pace) {
  if (pace.limit == PaceLimit::Torque) {
    return "larger torques (robot.limits), which limit the motion";
  }
  if (!pace.factor) return "";
  const double factor = rounded_up(*pace.factor);
  if (pace.limit == PaceLimit::Acceleration) {
    return fmt::format(
        "an approach.acceleration_limit {:.3g} times as large (the acceleration of {} limits the "
        "motion)",
        factor, pace.joint);
  }
  const double scale = problem.approach.velocity_scale;
  const std::string why = fmt::format("the rate of {} limits the motion", pace.joint);
  if (rounded_up(factor * scale) <= 1) {
    return fmt::format("an approach.velocity_scale of {:.3g}, now {:.3g} ({})",
                       rounded_up(factor * scale), scale, why);
  }
  const Joint& joint =
      problem.robot.joints[static_cast<std::size_t>(find_joint(problem.robot, pace.joint))];
  const double turn = joint.is_prismatic() ? 1 : kDegrees;
  return fmt::format(
      "approach.velocity_scale of 1, now {:.3g}, with a robot.limits.{}.rate of "
      "{:.3g} {}, now {:.3g} {} ({})",
      scale, pace.joint, rounded_up(turn * factor * scale * joint.max_velocity),
      joint.is_prismatic() ? "m/s" : "deg/s", turn * joint.max_velocity,
      joint.is_prismatic() ? "m/s" : "deg/s", why);
}

/// Where a feature can still be met at a time or after it; empty: none is known to.
std::string later_contact(const CaptureProblem& problem, double time) {
  CaptureProblem later = problem;
  later.variables.contact_time_lower = later.variables.contact_time_upper = time;
  const auto window = next_contact_window(later, time);
  if (!window) return "";
  return fmt::format("a later variables.contact_time ({} can be met from {:.4g} to {:.4g} s)",
                     window->feature, std::max(window->from, time), window->to);
}

std::string too_slow_advice(const Plan& plan) {
  const ApproachSpec& spec = plan.problem.approach;
  const Approach& approach = plan.approach;
  const CaptureProblem problem = at_feature(plan.problem, plan.configuration.feature);
  std::vector<std::string> advice;
  const auto add = [&](std::string words) {
    if (!words.empty()) advice.push_back(std::move(words));
  };
  const double late = approach.late_by;
  const double duration = pace_of_straight_motion(problem, plan.configuration, 0).duration;
  // By how much it is late is not known where it reaches back beyond the target's prediction.
  const double wanted = late > 0 ? duration - late : duration / 2;
  add(faster_words(problem, pace_of_straight_motion(problem, plan.configuration, wanted)));
  if (late > 0 && late < spec.wait) {
    add(fmt::format("an approach.wait of at most {:.3g} s", spec.wait - late));
  }
  if (duration + spec.wait > spec.max_duration) {
    add(fmt::format("an approach.max_duration above {:.4g} s, now {:.4g} s", duration + spec.wait,
                    spec.max_duration));
  } else {
    add(later_contact(problem, plan.configuration.contact_time + late));
  }
  if (advice.empty()) return "another robot.start, a target that comes later (target.state)";
  return fmt::format("{}", fmt::join(advice, ", "));
}

}  // namespace

std::string search_advice(const Plan& plan) {
  const CaptureProblem& problem = plan.problem;
  const VariableSpec& variables = problem.variables;
  const bool is_slow = violation_of(plan, limit_of(problem, "closing_speed")) > 0;
  const bool can_widen = problem.target && !problem.impulse.direction &&
                         (!is_slow || next_contact_window(problem, -kInfinity));
  std::vector<std::string> advice;
  if (is_slow && always_recedes(problem)) {
    // No posture and no other limit changes that.
    advice.emplace_back(
        "a target that comes faster, or turns slower or about another axis "
        "(target.state)");
    if (can_widen) advice.emplace_back("widen variables.contact_time");
    return fmt::format("what may help: {}", fmt::join(advice, ", "));
  }
  advice = loosening_advice(plan);
  if (variables.base_attitude == AttitudeFreedom::Fixed) {
    advice.emplace_back("free variables.base_attitude");
  }
  if (variables.base_position == PositionFreedom::Fixed) {
    advice.emplace_back("free variables.base_position");
  }
  if (can_widen) advice.emplace_back("widen variables.contact_time");
  advice.push_back(fmt::format("raise search.starts above {}", number_of_starts(problem.search)));
  return fmt::format("what may help: {}", fmt::join(advice, ", "));
}

std::string approach_advice(const Plan& plan) {
  const CaptureProblem& problem = plan.problem;
  switch (plan.approach.status) {
    case ApproachStatus::StartInvalid:
      return "another robot.start, or the pair in robot.allowed_contacts";
    case ApproachStatus::GoalInvalid:
    case ApproachStatus::HitEarly: {
      const std::string text = "constraints.clearance for the search, a shorter approach.wait";
      const HandMotionSpec& hand = problem.hand_motion;
      if (!hand.moves()) return text;
      const std::string of_hand =
          text +
          ", a larger approach.acceleration_limit or approach.velocity_scale, a larger "
          "constraints.joint_limit_margin";
      const std::string no_abort = "approach.abort: false where no path to rest is asked for";
      if (!problem.approach.abort) return of_hand;
      // A target whose linear velocity is not matched mostly closes in.
      if (hand.velocity == HandVelocity::Stated && !hand.linear) {
        return "contact.hand_velocity.linear of zero along the normal, " + no_abort + ", " +
               of_hand;
      }
      return of_hand + ", " + no_abort;
    }
    case ApproachStatus::TimeOut:
    case ApproachStatus::Interrupted:
    case ApproachStatus::Stopped:
      return "more time";
    case ApproachStatus::TooSlow:
      return too_slow_advice(plan);
    default:
      return "another robot.start, a smaller approach.clearance, more approach.max_iterations";
  }
}

}  // namespace stillbase::app
