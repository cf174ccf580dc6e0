// Which bound belongs to which capture problem, and how it is said.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "proof/minimum_problem.hpp"

namespace stillbase {
namespace {

using proof::BoundedMinimum;
using proof::MinimumProblem;

bool has_positive(const JointVectord& x) { return x.size() > 0 && x.maxCoeff() > 0; }

/// Where all postures are single points that the proof has enclosed.
bool is_list_of_points(const Proof& enclosed) {
  return enclosed.status == ProofStatus::Complete && !enclosed.lower_bound &&
         !enclosed.solutions.empty();
}

/// Constraints that the bound does not ask for.
std::vector<std::string> left_out(const CaptureProblem& problem, const MinimumProblem& bounded,
                                  bool only_points) {
  std::vector<std::string> out;
  const ConstraintSpec& constraints = problem.constraints;
  if (constraints.impact_case != CaseConstraint::None && !only_points) out.push_back("the case");
  const auto is_position = [](const proof::SideCondition& side) {
    return side.kind == proof::SideKind::BasePosition;
  };
  const auto& sides = bounded.where.side_conditions;
  if (problem.variables.base_position == PositionFreedom::Box &&
      std::none_of(sides.begin(), sides.end(), is_position)) {
    out.push_back("the base's position");
  }
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

/// What the measure is called.
std::string measure_name(const CaptureProblem& problem) {
  const std::string quantity = objective_name(problem);
  switch (problem.measure.kind) {
    case RiskMeasure::Nominal:
      return "a predicted " + quantity;
    case RiskMeasure::WorstCase:
      return "a worst case";
    case RiskMeasure::Expectation:
      return fmt::format("an expected {} ({} samples)", quantity, problem.measure.samples);
    case RiskMeasure::Cvar:
      return fmt::format("a CVaR of {} ({} samples)", quantity, problem.measure.samples);
  }
  return "";
}

std::string words(const CaptureProblem& problem, const MinimumProblem& bounded,
                  const BoundedMinimum& found, double best, bool only_points) {
  const std::string unit = objective_unit_name(problem);
  const std::string what = measure_name(problem);
  const std::string place = bounded.where.encounter.is_fixed() ? "posture" : "configuration";
  if (found.nothing_as_good) {
    return fmt::format("contradiction: no {} has {} as small as {:.4g} {}", place, what, best,
                       unit);
  }
  const std::string stopped = found.limit_reached ? ", stopped at the limit" : "";
  if (!(found.lower_bound > 0)) return fmt::format("no bound for {}{}", what, stopped);
  std::string text = fmt::format("no {} has {} below {} {} (best candidate {:.4g}, gap {:.2g} %{})",
                                 place, what, rounded_down(found.lower_bound), unit, best,
                                 100 * std::max(0.0, best - found.lower_bound) / best, stopped);
  const std::vector<std::string> missing = left_out(problem, bounded, only_points);
  for (std::size_t i = 0; i < missing.size(); ++i) {
    text += (i == 0 ? ", not counting " : ", ") + missing[i];
  }
  return text;
}

/// Where the encounter's variables are x, everything else as stated.
Configuration configuration_at(const CaptureProblem& problem, const proof::VariableEncounter& model,
                               const Eigen::VectorXd& x) {
  Configuration out{model.start, problem.base, problem.variables.contact_time_lower};
  for (std::size_t i = 0; i < model.free.size(); ++i) {
    out.phi[model.free[i]] = x[static_cast<Eigen::Index>(i)];
  }
  if (model.attitude_is_free) {
    const Eigen::AngleAxisd turn(x[model.attitude_index()], model.attitude_axis);
    out.base.orientation = turn * problem.base.orientation;
  }
  if (!model.turn_basis.empty()) {
    Vector3d sigma = Vector3d::Zero();
    for (std::size_t i = 0; i < model.turn_basis.size(); ++i) {
      sigma += x[model.attitude_index() + static_cast<Eigen::Index>(i)] * model.turn_basis[i];
    }
    const Vector3d part = 2 * sigma;
    const Eigen::Quaterniond turn(1 - sigma.squaredNorm(), part.x(), part.y(), part.z());
    out.base.orientation = (turn.normalized() * problem.base.orientation).normalized();
  }
  if (model.time_is_free) out.contact_time = x[model.time_index()] * model.time_unit;
  return out;
}

}  // namespace

std::string minimum_objection(const CaptureProblem& problem) {
  const VariableSpec& variables = problem.variables;
  if (simulates_turn(problem)) return "the turn after the impact is simulated";
  const bool is_mean =
      problem.measure.kind == RiskMeasure::Expectation || problem.measure.kind == RiskMeasure::Cvar;
  if (is_mean && has_positive(problem.uncertainty.joint_position)) {
    return "the samples differ in their posture";
  }
  const auto joints = std::count(variables.joints.begin(), variables.joints.end(), true);
  if (joints > 3) {  // before a target's motion is enclosed for nothing
    return fmt::format("it takes one to three free variables, here are {} joints", joints);
  }
  const MinimumProblem bounded = proof::minimum_problem(problem, {});
  const proof::VariableEncounter& encounter = bounded.where.encounter;
  if (is_mean && problem.uncertainty.contact_time > 0 && encounter.time_is_free) {
    return "the samples differ in their contact time, which is free";
  }
  const int free = encounter.num_variables();
  if (free < 1 || free > 3) {
    return fmt::format("it takes one to three free variables, here are {}", free);
  }
  if (problem.robot.n() > proof::max_minimum_joints()) {
    return fmt::format("more than {} joints", proof::max_minimum_joints());
  }
  if (encounter.spin && !encounter.spin->is_valid()) {
    return "the target tumbles too often until the contact";
  }
  for (std::size_t i = 0; i < encounter.free.size(); ++i) {
    const Joint& joint = problem.robot.joints[static_cast<std::size_t>(encounter.free[i])];
    if (joint.type == JointType::Continuous) continue;
    if (!std::isfinite(encounter.lower[i]) || !std::isfinite(encounter.upper[i])) {
      return "a free joint has no limits";
    }
    if (!(encounter.lower[i] <= encounter.upper[i])) return "a free joint has no room";
  }
  return "";
}

MinimumBound prove_minimum(const CaptureProblem& problem, const std::vector<Scenario>& scenarios,
                           const Proof& enclosed, double best, const MinimumOptions& options) {
  MinimumProblem bounded = proof::minimum_problem(problem, scenarios);
  const bool only_points = is_list_of_points(enclosed);
  if (only_points) bounded.places = enclosed.solutions;
  const proof::VariableEncounter& encounter = bounded.where.encounter;
  std::function<double(const Eigen::VectorXd&)> value_at;
  if (options.value_at) {
    value_at = [&](const Eigen::VectorXd& x) {
      return options.value_at(configuration_at(problem, encounter, x));
    };
  }
  const BoundedMinimum found = proof::bound_minimum(bounded, best, options, value_at);
  MinimumBound out;
  out.limit_reached = found.limit_reached;
  for (const Eigen::VectorXd& x : found.suspects) {
    out.suspects.push_back(configuration_at(problem, encounter, x));
  }
  out.boxes = found.boxes;
  // A bound just above the best value is that value's rounding.
  out.lower_bound = found.nothing_as_good ? found.lower_bound : std::min(found.lower_bound, best);
  out.gap = best - out.lower_bound;
  out.statement = words(problem, bounded, found, best, only_points);
  return out;
}

}  // namespace stillbase
