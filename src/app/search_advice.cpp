#include "app/search_advice.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/search/search.hpp>

namespace stillbase::app {

namespace {

/// What loosens the constraints of a name that begins so.
struct Loosening {
  const char* name;
  const char* advice;
};
constexpr Loosening kLoosenings[] = {
    {"closing_speed",
     "a smaller constraints.closing_speed_min, a target that comes faster (target.state)"},
    {"arrival_rate",
     "a larger approach.velocity_scale, less of the motion in contact.hand_velocity, a target that "
     "turns or comes slower (target.state)"},
    {"clearance", "a smaller constraints.clearance"},
    {"base_attitude", "a larger variables.base_attitude.max"},
};

/// Those of the constraints that the nearest attempt violates, the most violated one of a kind
/// deciding on the order.
std::vector<std::string> loosening_advice(const Plan& plan) {
  std::vector<std::pair<double, std::string>> found;
  for (const Loosening& loosening : kLoosenings) {
    double worst = 0;
    for (const ConstraintValue& constraint : plan.constraints) {
      if (constraint.name.rfind(loosening.name, 0) != 0) continue;
      if (!(constraint.violation > kFeasibilityTolerance)) continue;
      const double bound =
          constraint.value > constraint.upper ? constraint.upper : constraint.lower;
      worst = std::max(worst, constraint.violation / std::max(std::abs(bound), 1e-9));
    }
    if (worst > 0) found.emplace_back(-worst, loosening.advice);
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> out;
  for (auto& [order, advice] : found) out.push_back(std::move(advice));
  return out;
}

}  // namespace

std::string search_advice(const Plan& plan) {
  const CaptureProblem& problem = plan.problem;
  const VariableSpec& variables = problem.variables;
  std::vector<std::string> advice = loosening_advice(plan);
  if (variables.base_attitude == AttitudeFreedom::Fixed) {
    advice.emplace_back("free variables.base_attitude");
  }
  if (variables.base_position == PositionFreedom::Fixed) {
    advice.emplace_back("free variables.base_position");
  }
  if (problem.target && !problem.impulse.direction) {
    advice.emplace_back("widen variables.contact_time");
  }
  advice.push_back(fmt::format("raise search.starts above {}", first_starts(problem.search)));
  return fmt::format("what may help: {}", fmt::join(advice, ", "));
}

std::string approach_advice(const CaptureProblem& problem, ApproachStatus status) {
  switch (status) {
    case ApproachStatus::StartInvalid:
      return "another robot.start, or the pair in robot.allowed_contacts";
    case ApproachStatus::GoalInvalid:
    case ApproachStatus::HitEarly: {
      std::string text = "constraints.clearance for the search, a shorter approach.wait";
      const HandMotionSpec& hand = problem.hand_motion;
      if (!hand.moves()) return text;
      text +=
          ", a larger approach.acceleration_limit or approach.velocity_scale, a larger "
          "constraints.joint_limit_margin";
      if (!problem.approach.abort) return text;
      if (hand.velocity == HandVelocity::Stated && !hand.linear) {
        text += ", contact.hand_velocity.linear of zero along the normal";
      }
      return text + ", approach.abort: false where no path to rest is asked for";
    }
    case ApproachStatus::TimeOut:
    case ApproachStatus::Interrupted:
    case ApproachStatus::Stopped:
      return "more time";
    case ApproachStatus::TooSlow:
      return "a larger approach.acceleration_limit, a later variables.contact_time";
    default:
      return "another robot.start, a smaller approach.clearance, more approach.max_iterations";
  }
}

}  // namespace stillbase::app
