// Which bound belongs to which capture problem, and how it is said.
#include <stillbase/impact/gradient.hpp>
#include <stillbase/plan/scenario.hpp>
#include <stillbase/proof/minimum.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace stillbase {
namespace {

bool hand_is_held(const CaptureProblem& problem) {
  return problem.variables.base_position == PositionFreedom::Fixed &&
         problem.hand.constraint != HandConstraint::None;
}

/// Where all postures are single points that the proof has enclosed.
bool is_list_of_points(const Proof& enclosed) {
  return enclosed.status == ProofStatus::Complete && !enclosed.lower_bound &&
         !enclosed.solutions.empty();
}

MinimumProblem minimum_problem(const CaptureProblem& problem) {
  MinimumProblem out;
  out.robot = problem.robot;
  out.start = problem.start;
  out.objective = problem.objective;
  const ImpactResistance resistance = prepare_resistance(problem.resistance, problem.robot.n());
  out.added_inertia = resistance.added_inertia;
  out.locked = resistance.locked;
  const double margin = problem.constraints.joint_limit_margin;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const auto index = static_cast<std::size_t>(k);
    if (!problem.variables.joints[index]) continue;
    out.free.push_back(k);
    out.lower.push_back(problem.robot.joints[index].lower + margin);
    out.upper.push_back(problem.robot.joints[index].upper - margin);
  }
  if (hand_is_held(problem)) {
    out.has_hand_point = true;
    out.hand_point = problem.hand.frame == Frame::Base
                         ? *problem.hand.position
                         : Vector3d(problem.base.orientation.conjugate() *
                                    (*problem.hand.position - problem.base.position));
  }
  return out;
}

/// Constraints that the bound does not ask for.
std::vector<std::string> left_out(const CaptureProblem& problem, bool only_points) {
  std::vector<std::string> out;
  const ConstraintSpec& constraints = problem.constraints;
  const HandConstraint hand = problem.hand.constraint;
  if (constraints.impact_case != CaseConstraint::None && !only_points) out.push_back("the case");
  if (hand == HandConstraint::Axis || hand == HandConstraint::Pose)
    out.push_back("the hand's axes");
  if (problem.variables.base_position == PositionFreedom::Box) out.push_back("the base's position");
  if (constraints.joint_rate_scale || constraints.joint_rate_max.size() > 0) {
    out.push_back("joint rates");
  }
  if (constraints.coupling_singular_value_min > 0 || constraints.jacobian_singular_value_min > 0) {
    out.push_back("singular values");
  }
  if (constraints.clearance) out.push_back("clearances");
  return out;
}

/// Four digits, rounded down: no more than was proven.
std::string rounded_down(double x) {
  if (!(x > 0)) return "0";
  const double unit = std::pow(10, std::floor(std::log10(x)) - 3);
  return fmt::format("{:.4g}", std::floor(x / unit) * unit);
}

std::string words(const CaptureProblem& problem, const BoundedMinimum& found, double best,
                  bool only_points) {
  const std::string unit = objective_unit_name(problem);
  const bool worst = problem.measure.kind == RiskMeasure::WorstCase;
  const std::string what = worst ? "a worst case" : "a predicted " + objective_name(problem);
  if (found.nothing_as_good) {
    return fmt::format("contradiction: no posture has {} as small as {:.4g} {}", what, best, unit);
  }
  const std::string stopped = found.limit_reached ? ", stopped at the limit" : "";
  if (!(found.lower_bound > 0)) return fmt::format("no bound for {}{}", what, stopped);
  std::string text =
      fmt::format("no posture has {} below {} {} (best candidate {:.4g}, gap {:.2g} %{})", what,
                  rounded_down(found.lower_bound), unit, best,
                  100 * std::max(0.0, best - found.lower_bound) / best, stopped);
  const std::vector<std::string> missing = left_out(problem, only_points);
  for (std::size_t i = 0; i < missing.size(); ++i) {
    text += (i == 0 ? ", not counting " : ", ") + missing[i];
  }
  return text;
}

}  // namespace

std::string minimum_objection(const CaptureProblem& problem) {
  const VariableSpec& variables = problem.variables;
  if (variables.base_attitude != AttitudeFreedom::Fixed) return "the base attitude is free";
  if (variables.contact_time_upper > variables.contact_time_lower) {
    return "the contact time is free";
  }
  if (problem.measure.kind == RiskMeasure::Expectation ||
      problem.measure.kind == RiskMeasure::Cvar) {
    return "the measure is a mean over samples";
  }
  if (simulates_turn(problem)) return "the turn after the impact is simulated";
  if (hand_is_held(problem) && !problem.hand.position) return "the hand meets a moving target";
  const long free = std::count(variables.joints.begin(), variables.joints.end(), true);
  if (free < 1 || free > 3) {
    return fmt::format("it takes one to three free joints, here are {}", free);
  }
  if (problem.robot.n() > max_minimum_joints()) {
    return fmt::format("more than {} joints", max_minimum_joints());
  }
  const MinimumProblem box = minimum_problem(problem);
  for (std::size_t i = 0; i < box.free.size(); ++i) {
    const Joint& joint = problem.robot.joints[static_cast<std::size_t>(box.free[i])];
    if (joint.type == JointType::Continuous) continue;
    if (!std::isfinite(box.lower[i]) || !std::isfinite(box.upper[i])) {
      return "a free joint has no limits";
    }
    if (!(box.lower[i] <= box.upper[i])) return "a free joint has no room";
  }
  return "";
}

MinimumBound prove_minimum(const CaptureProblem& problem, const std::vector<ImpulseCase>& impulses,
                           const Proof& enclosed, double best, const MinimumOptions& options) {
  MinimumProblem bounded = minimum_problem(problem);
  bounded.impulses = impulses;
  const bool only_points = is_list_of_points(enclosed);
  if (only_points) bounded.places = enclosed.solutions;
  const BoundedMinimum found = bound_minimum(bounded, best, options);
  MinimumBound out;
  out.boxes = found.boxes;
  // A bound just above the best value is that value's rounding.
  out.lower_bound = found.nothing_as_good ? found.lower_bound : std::min(found.lower_bound, best);
  out.gap = best - out.lower_bound;
  out.statement = words(problem, found, best, only_points);
  return out;
}

}  // namespace stillbase
