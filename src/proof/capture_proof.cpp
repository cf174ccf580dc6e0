// Which proof belongs to which capture problem.
#include <stillbase/impact/gradient.hpp>
#include <stillbase/proof/proof.hpp>

namespace stillbase {
namespace {

/// Why a problem cannot be proven; empty: it can.
std::string objection(const CaptureProblem& problem) {
  const VariableSpec& variables = problem.variables;
  if (variables.base_attitude != AttitudeFreedom::Fixed) return "the base attitude is free";
  if (variables.contact_time_upper > variables.contact_time_lower)
    return "the contact time is free";
  if (variables.base_position == PositionFreedom::Box) return "the base position is bounded";
  const bool hand_counts = variables.base_position == PositionFreedom::Fixed;
  const HandConstraint hand = problem.hand.constraint;
  if (hand == HandConstraint::Axis || hand == HandConstraint::Pose) {
    return "the hand's orientation is constrained";
  }
  if (hand == HandConstraint::Position && hand_counts && !problem.hand.position) {
    return "the hand meets a moving target";
  }
  const ConstraintSpec& constraints = problem.constraints;
  if (constraints.joint_rate_scale || constraints.joint_rate_max.size() > 0 ||
      constraints.coupling_singular_value_min > 0 || constraints.jacobian_singular_value_min > 0 ||
      constraints.clearance) {
    return "rates, singular values or clearances are constrained";
  }
  return "";
}

ZeroProblem zero_problem(const CaptureProblem& problem, const Vector6d& F) {
  ZeroProblem out;
  out.robot = problem.robot;
  out.start = problem.start;
  out.F = F;
  out.impact_case = problem.constraints.impact_case;
  const ImpactResistance resistance = prepare_resistance(problem.resistance, problem.robot.n());
  out.added_inertia = resistance.added_inertia;
  out.locked = resistance.locked;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const auto index = static_cast<std::size_t>(k);
    if (!problem.variables.joints[index]) continue;
    const Joint& joint = problem.robot.joints[index];
    const double margin = problem.constraints.joint_limit_margin;
    out.free.push_back(k);
    out.lower.push_back(joint.lower + margin);
    out.upper.push_back(joint.upper - margin);
  }
  if (problem.hand.constraint == HandConstraint::Position && problem.hand.position &&
      problem.variables.base_position == PositionFreedom::Fixed) {
    out.has_hand_point = true;
    out.hand_point = problem.hand.frame == Frame::Base
                         ? *problem.hand.position
                         : Vector3d(problem.base.orientation.conjugate() *
                                    (*problem.hand.position - problem.base.position));
  }
  return out;
}

/// Whether the objective is one angular quantity, whose zeros are equations without division.
bool is_angular(const std::vector<ObjectiveTerm>& objective) {
  if (objective.size() != 1) return false;
  switch (objective.front().quantity) {
    case ObjectiveQuantity::BaseAngularMomentum:
    case ObjectiveQuantity::BaseAngularVelocity:
    case ObjectiveQuantity::TotalAngularMomentum:
      return true;
    default:
      return false;
  }
}

}  // namespace

Proof prove(const CaptureProblem& problem, const Vector6d& F, const ProofOptions& options) {
  const std::string reason = objection(problem);
  if (!reason.empty()) {
    Proof out;
    out.statement = "no proof: " + reason;
    return out;
  }
  ZeroProblem zeros = zero_problem(problem, F);
  Proof out = enclose_solutions(zeros, options);
  if (out.status != ProofStatus::NotApplicable) return out;
  // The equations leave freedom: ask where the predicted objective vanishes.
  if (!is_angular(problem.objective)) return out;
  zeros.zero = problem.objective.front().quantity;
  Proof vanishing = enclose_solutions(zeros, options);
  if (vanishing.status == ProofStatus::NotApplicable) return out;
  if (vanishing.status == ProofStatus::Complete && vanishing.solutions.empty()) {
    vanishing.statement = "proven: no posture that meets the constraints makes the objective zero";
  } else {
    vanishing.statement += " at which the objective is zero";
  }
  if (!vanishing.solutions.empty()) vanishing.lower_bound = 0;
  return vanishing;
}

}  // namespace stillbase
