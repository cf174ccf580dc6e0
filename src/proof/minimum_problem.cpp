// Which lower bound belongs to which capture problem, and how it is said.
#include "proof/minimum_problem.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plan/proof_words.hpp"
#include "proof/solution_reach.hpp"

namespace stillbase::proof {
namespace {

bool has_row(const std::vector<Row>& rows, RowKind kind) {
  return std::any_of(rows.begin(), rows.end(), [kind](const Row& row) { return row.kind == kind; });
}

/// Whether wrench or hand point change with the base attitude.
bool depends_on_attitude(const ZeroProblem& where) {
  const VariableEncounter& encounter = where.encounter;
  const bool is_point_in_base = encounter.hand_point && encounter.hand_frame == Frame::Base;
  return encounter.frame != ContactFrame::Base ||
         (has_row(where.hand_equations, RowKind::HandPosition) && !is_point_in_base);
}

/// Whether of a free attitude only the direction of the impulse in B counts, so that rotations
/// about that direction change nothing.
bool counts_by_direction(const CaptureProblem& problem, const ZeroProblem& where) {
  const VariableEncounter& encounter = where.encounter;
  if (problem.variables.base_attitude != AttitudeFreedom::Free ||
      encounter.has(VariableKind::Time) || !encounter.moment.isZero(0) ||
      !where.hand_equations.empty() || has_row(where.inequalities, RowKind::BasePosition)) {
    return false;
  }
  if (problem.measure.kind == RiskMeasure::Nominal) return true;
  // A cone is symmetric about its axis; the law of the impulse has to be, too.
  return problem.measure.kind == RiskMeasure::WorstCase && !problem.uncertainty.cone_plane_normal &&
         encounter.frame == ContactFrame::Inertial &&
         problem.impulse.source != ImpulseSource::RigidBody;
}

/// Target and E as it is nominally, relative to each other where the target is ahead of its nominal
/// motion: it has rotated.
ContactKinematics<double> contact_in_E(const VariableEncounter& encounter, double time_offset) {
  ContactKinematics<double> out;
  const bool is_time_free = encounter.has(VariableKind::Time);
  if (encounter.follows_target() && !is_time_free) {
    out = contact_kinematics<double>(encounter, encounter.R_NT,
                                     encounter.earliest_time + time_offset);
  }
  if (is_time_free || time_offset == 0) out.R_EB.setIdentity();
  return out;
}

ImpulseCase impulse_case(const VariableEncounter& encounter, const Scenario& scenario) {
  const double offset = encounter.follows_target() ? scenario.time_offset : 0;
  const Encounter<double> in_E =
      encounter_along<double>(encounter, contact_in_E(encounter, offset), scenario);
  ImpulseCase out;
  out.weight = scenario.weight;
  out.F = in_E.F;
  if (encounter.magnitude_is_given()) {
    out.numerator = encounter.magnitude;
    return out;
  }
  out.numerator = 1 + scenario.restitution;
  if (encounter.spin) {
    out.closing =
        ImpulseCase::Closing{encounter.r + scenario.contact_offset, scenario.closing_speed_offset};
  } else {
    out.numerator *= std::max(in_E.closing_speed, 0.0);
  }
  out.target_inverse_mass = in_E.target_inverse_mass;
  return out;
}

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
  if (problem.constraints.impact_case != CaseConstraint::None && !only_points) {
    out.push_back("the case");
  }
  if (problem.variables.base_position == PositionFreedom::Box &&
      !has_row(bounded.where.inequalities, RowKind::BasePosition)) {
    out.push_back("the base's position");
  }
  const std::vector<std::string>& limits = bounded.where.uncounted_limits;
  out.insert(out.end(), limits.begin(), limits.end());
  return out;
}

/// Four digits, rounded down: no more than was proven.
std::string rounded_down(double x) {
  if (!(x > 0)) return "0";
  const double unit = std::pow(10, std::floor(std::log10(x)) - 3);
  return fmt::format("{:.4g}", std::floor(x / unit) * unit);
}

std::string words(const CaptureProblem& problem, const MinimumProblem& bounded, const Bound& found,
                  double best, bool only_points) {
  const std::string unit = objective_unit_name(problem);
  const std::string what = measure_name(problem);
  const std::string place = bounded.where.encounter.is_fixed() ? "posture" : "configuration";
  if (found.nothing_below_cut) {
    return fmt::format("contradiction: no {} has {} as small as {:.4g} {}", place, what, best,
                       unit);
  }
  const std::string stopped = found.limit_reached ? ", stopped at the limit" : "";
  if (!(found.lower > 0)) return fmt::format("no bound for {}{}", what, stopped);
  std::string text = fmt::format("no {} has {} below {} {} (best candidate {:.4g}, gap {:.2g} %{})",
                                 place, what, rounded_down(found.lower), unit, best,
                                 100 * std::max(0.0, best - found.lower) / best, stopped);
  const std::vector<std::string> missing = left_out(problem, bounded, only_points);
  for (std::size_t i = 0; i < missing.size(); ++i) {
    text += (i == 0 ? ", not counting " : ", ") + missing[i];
  }
  return text;
}

/// Where the encounter's variables are x, everything else as stated.
Configuration configuration_at(const CaptureProblem& problem, const VariableEncounter& model,
                               const Eigen::VectorXd& x) {
  Configuration out{model.start, problem.base, problem.variables.contact_time_lower};
  Vector3d sigma = Vector3d::Zero();
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Variable& variable = model.variables[static_cast<std::size_t>(i)];
    switch (variable.kind) {
      case VariableKind::Joint:
        out.phi[variable.joint] = x[i];
        break;
      case VariableKind::BaseAngle:
        out.base.orientation = Eigen::AngleAxisd(x[i], variable.axis) * problem.base.orientation;
        break;
      case VariableKind::BaseParameter:
        sigma += x[i] * variable.axis;
        break;
      case VariableKind::Time:
        out.contact_time = x[i] * model.time_unit;
    }
  }
  if (model.has(VariableKind::BaseParameter)) {
    const Vector3d part = 2 * sigma;
    const Eigen::Quaterniond rotation(1 - sigma.squaredNorm(), part.x(), part.y(), part.z());
    out.base.orientation = (rotation.normalized() * problem.base.orientation).normalized();
  }
  return out;
}

}  // namespace

MinimumProblem minimum_problem(const CaptureProblem& problem,
                               const std::vector<Scenario>& scenarios) {
  MinimumProblem out;
  out.where = zero_problem(problem);
  VariableEncounter& encounter = out.where.encounter;
  const auto is_of_base = [](const Variable& variable) {
    return variable.kind == VariableKind::BaseAngle || variable.kind == VariableKind::BaseParameter;
  };
  std::vector<Variable>& variables = encounter.variables;
  if (encounter.is_attitude_free() && !depends_on_attitude(out.where)) {
    std::erase_if(variables, is_of_base);
    out.where.inequalities.clear();
  }
  if (!encounter.spin) {
    std::erase_if(variables, [](const Variable& v) { return v.kind == VariableKind::Time; });
  }
  if (encounter.has(VariableKind::BaseParameter) && counts_by_direction(problem, out.where)) {
    // Rotations about axes across it bring it into every direction.
    const auto first = std::find_if(variables.begin(), variables.end(), is_of_base);
    first[0].axis = encounter.u;
    first[1].axis = encounter.v;
    variables.erase(first + 2);
    for (int i = 0; i < 2 && encounter.frame == ContactFrame::Target; ++i) {
      first[i].axis = encounter.R_NT * first[i].axis;
    }
  }
  for (Row& row : out.where.inequalities) {
    row.lower -= out.tolerances.feasible;
    row.upper += out.tolerances.feasible;
  }
  out.objective = problem.objective;
  out.measure = problem.measure.kind;
  out.cvar_level = problem.measure.cvar_level;
  for (const Scenario& scenario : scenarios) {
    out.impulses.push_back(impulse_case(encounter, scenario));
  }
  return out;
}

}  // namespace stillbase::proof

namespace stillbase {

std::string minimum_objection(const CaptureProblem& problem) {
  const VariableSpec& variables = problem.variables;
  if (problem.impulse.contact != ContactLaw::Frictionless) {
    return "only an impulse along the normal is enclosed, not that of this contact";
  }
  if (problem.uncertainty.residual_velocity && problem.measure.kind != RiskMeasure::Nominal) {
    return "there is no bound for a measure over the residual velocity";
  }
  if (problem.robot.is_coupled()) return "some joints follow others";
  if (simulates_turn(problem)) return "the turn after the impact is simulated";
  const bool is_mean =
      problem.measure.kind == RiskMeasure::Expectation || problem.measure.kind == RiskMeasure::Cvar;
  if (is_mean && proof::has_positive(problem.uncertainty.joint_position)) {
    return "the samples differ in their posture";
  }
  const auto joints = std::count(variables.joints.begin(), variables.joints.end(), true);
  if (joints > 3) {  // before a target's motion is enclosed for nothing
    return fmt::format("it takes one to three free variables, here are {} joints", joints);
  }
  const proof::MinimumProblem bounded = proof::minimum_problem(problem, {});
  const proof::VariableEncounter& encounter = bounded.where.encounter;
  if (is_mean && problem.uncertainty.contact_time > 0 && encounter.has(proof::VariableKind::Time)) {
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
  for (const proof::Variable& variable : encounter.variables) {
    if (variable.kind != proof::VariableKind::Joint || variable.is_periodic) continue;
    if (!std::isfinite(variable.lower) || !std::isfinite(variable.upper)) {
      return "a free joint has no limits";
    }
    if (!(variable.lower <= variable.upper)) return "a free joint has no room";
  }
  return "";
}

MinimumBound prove_minimum(const CaptureProblem& problem, const std::vector<Scenario>& scenarios,
                           const Proof& enclosed, double best, const MinimumOptions& options) {
  proof::MinimumProblem bounded = proof::minimum_problem(problem, scenarios);
  if (proof::is_list_of_points(enclosed)) {
    bounded.places = proof::reach_of_solutions(proof::zero_problem(problem), enclosed.solutions);
  }
  const bool only_points = !bounded.places.empty();
  const auto configuration_at = [&](const Eigen::VectorXd& x) {
    return proof::configuration_at(problem, bounded.where.encounter, x);
  };
  const Power power = objective_power(problem);
  proof::MinimumCallbacks at;
  if (options.value_at) {
    at.value = [&](const Eigen::VectorXd& x) {
      return power.length(options.value_at(configuration_at(x)));
    };
  }
  if (options.worst_at) {
    at.worst_impulses = [&](const Eigen::VectorXd& x) {
      std::vector<proof::WorstImpulse> out;
      for (const WorstEncounter& worst : options.worst_at(configuration_at(x))) {
        out.push_back({proof::impulse_case(bounded.where.encounter, worst.scenario),
                       power.length(worst.value)});
      }
      return out;
    };
  }
  proof::Bound found = proof::bound_minimum(bounded, power.length(best), options, at);
  found.lower = power.value(found.lower);
  MinimumBound out;
  out.limit_reached = found.limit_reached;
  for (const Eigen::VectorXd& x : found.suspects) out.suspects.push_back(configuration_at(x));
  out.boxes = found.boxes;
  // A bound just above the best value is that value's rounding.
  out.lower_bound = found.nothing_below_cut ? found.lower : std::min(found.lower, best);
  out.gap = best - out.lower_bound;
  out.statement = proof::words(problem, bounded, found, best, only_points);
  return out;
}

}  // namespace stillbase
