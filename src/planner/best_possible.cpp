#include "planner/best_possible.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/formulation/measures/robust.hpp>

#include "formulation/measures/measure.hpp"
#include "planner/candidates.hpp"

namespace stillbase {

namespace {

/// Whether the wedge's plane is the same in the contact frame at every configuration.
bool is_wedge_constant(const CaptureProblem& problem, double parallel) {
  const bool is_in_base =
      problem.impulse.direction && problem.impulse.direction_frame == Frame::Base;
  if (is_in_base) return true;
  const Vector3d normal = problem.base.orientation * *problem.uncertainty.cone_plane_normal;
  const auto turns_within = [&](const Vector3d& axis) {
    return axis.cross(normal).norm() <= parallel * axis.norm();
  };
  const VariableSpec& variables = problem.variables;
  if (variables.base_attitude == AttitudeFreedom::Cone ||
      variables.base_attitude == AttitudeFreedom::Free) {
    return false;
  }
  if (variables.base_attitude == AttitudeFreedom::Axis &&
      !turns_within(variables.base_attitude_axis)) {
    return false;
  }
  if (problem.impulse.direction || variables.contact_time_upper == variables.contact_time_lower) {
    return true;
  }
  const TargetBody& target = *problem.target;
  const Eigen::Quaterniond R_TN = problem.target_state.pose.orientation.conjugate();
  const Vector3d omega = R_TN * problem.target_state.angular_velocity;
  const Vector3d L = target.inertia * omega;
  const bool keeps_axis =
      target.is_point_mass || L.cross(omega).norm() <= parallel * L.norm() * omega.norm();
  return keeps_axis && turns_within(problem.target_state.angular_velocity);
}

/// Directions within the cone about n, in the contact frame: its rim and some between.
/// @param plane_normal of the wedge, in the same frame
std::vector<Vector3d> spread_directions(const CaptureProblem& problem, const Vector3d& n,
                                        const std::optional<Vector3d>& plane_normal,
                                        const BoundOptions& options) {
  std::vector<Vector3d> out;
  const double alpha = problem.uncertainty.cone_half_angle;
  const auto add = [&](const Vector3d& side, double angle) {
    out.push_back(std::cos(angle) * n + std::sin(angle) * side);
  };
  if (plane_normal) {
    const Vector3d side = plane_normal->cross(n).normalized();
    for (int i = 1; i <= options.wedge_directions; ++i) {
      add(side, alpha * i / options.wedge_directions);
      add(side, -alpha * i / options.wedge_directions);
    }
    return out;
  }
  const Vector3d u = n.unitOrthogonal(), v = n.cross(u);
  for (int spoke = 0; spoke < options.spokes; ++spoke) {
    const double azimuth = 2 * kPi * spoke / options.spokes;
    const Vector3d side = std::cos(azimuth) * u + std::sin(azimuth) * v;
    add(side, alpha);
    if (spoke % 2 == 0) add(side, alpha / 2);
  }
  return out;
}

/// Encounters along a cone's maxima at a configuration, those that are nearly as bad as the worst.
std::vector<WorstEncounter> worst_encounters(const CaptureProblem& problem,
                                             const Formulation& formulation,
                                             const Configuration& at, const BoundOptions& options) {
  std::vector<WorstEncounter> out;
  const auto maxima = cone_maxima(problem, formulation, at);
  for (const ConeMaximum& maximum : maxima) {
    if (maximum.value < options.nearly_active * maxima.front().value) continue;
    out.push_back({maximum.scenario, maximum.value});
  }
  return out;
}

/// The same at the best candidates: there the bound has to be sharp.
std::vector<Vector3d> active_directions(const CaptureProblem& problem,
                                        const Formulation& formulation, const SearchResult& found,
                                        double best, const BoundOptions& options) {
  std::vector<Vector3d> out;
  int looked_at = 0;
  for (const Candidate& candidate : found.candidates) {
    if (candidate.value > options.nearly_best * best || ++looked_at > options.candidates) continue;
    for (const WorstEncounter& worst :
         worst_encounters(problem, formulation, candidate.configuration, options)) {
      out.push_back(worst.scenario.direction);
    }
  }
  return out;
}

/// A direction of the cone that rounding leaves in it.
Vector3d moved_inside(const Vector3d& direction, const Scenario& nominal,
                      const BoundOptions& options) {
  return (direction + options.inside * nominal.direction).normalized();
}

/// Adds encounters along directions within the cone that are not among the known ones.
void add_directions(const std::vector<Vector3d>& directions, const Scenario& nominal,
                    const BoundOptions& options, std::vector<Scenario>& known) {
  for (const Vector3d& direction : directions) {
    const Vector3d inside = moved_inside(direction, nominal, options);
    const auto is_same = [&](const Scenario& other) {
      return (other.direction - inside).norm() < options.same_direction;
    };
    if (std::any_of(known.begin(), known.end(), is_same)) continue;
    known.push_back(nominal);
    known.back().direction = inside;
  }
}

/// The encounters over which the measure is bounded.
std::vector<Scenario> scenarios_of(const CaptureProblem& problem, const Formulation& formulation,
                                   const SearchResult& found, double best,
                                   const BoundOptions& options) {
  const RiskMeasure measure = problem.measure.kind;
  if (measure == RiskMeasure::Expectation || measure == RiskMeasure::Cvar) {
    return draw_scenarios(problem);
  }
  const Scenario nominal = formulation.nominal_scenario();
  const Vector3d n = nominal.direction;
  std::vector<Scenario> out = {nominal};
  const bool is_cone = problem.uncertainty.cone_half_angle > 0;
  if (measure != RiskMeasure::WorstCase || !is_cone) return out;
  std::optional<Vector3d> plane_normal;
  if (problem.uncertainty.cone_plane_normal) {
    // A wedge that rotates with the base has only its middle direction at all configurations.
    if (!is_wedge_constant(problem, options.parallel)) return out;
    plane_normal =
        encounter_at(formulation.encounter_model(), start_configuration(problem)).contact.R_EB *
        *problem.uncertainty.cone_plane_normal;
  }
  std::vector<Vector3d> directions = active_directions(problem, formulation, found, best, options);
  for (const Vector3d& direction : spread_directions(problem, n, plane_normal, options)) {
    directions.push_back(direction);
  }
  add_directions(directions, nominal, options, out);
  return out;
}

}  // namespace

std::optional<double> best_value(const SearchResult& found) {
  std::optional<double> best;
  for (std::size_t c = 0; c < found.candidates.size(); ++c) {
    if (status_of(found.certificates[c]) == PlanStatus::Infeasible) continue;
    const double value = found.candidates[c].value;
    best = best ? std::min(*best, value) : value;
  }
  return best;
}

bool is_zero_reached(const Formulation& formulation, const SearchResult& found) {
  const std::optional<double> best = best_value(found);
  return best && *best <= formulation.objective_power().value(kZeroObjective *
                                                              formulation.objective_unit());
}

std::optional<MinimumBound> bound_measure(const Prover* prover, const CaptureProblem& problem,
                                          const Formulation& formulation, const SearchResult& found,
                                          const Proof& enclosed, MinimumOptions options,
                                          const BoundOptions& bound) {
  // A path that decides the contact configuration leads to other encounters.
  if (!prover || !prover->minimum_objection(problem).empty() || path_decides(problem)) {
    return std::nullopt;
  }
  const std::optional<double> best = best_value(found);
  if (!best || is_zero_reached(formulation, found)) return std::nullopt;
  Measure measure(problem, formulation);
  options.value_at = [&](const Configuration& at) {
    const Eigen::VectorXd x = formulation.variables(at);
    for (const ConstraintValue& constraint : formulation.report(x)) {
      if (!(constraint.violation <= kFeasibilityTolerance)) return kInfinity;
    }
    return measure.reported(x);
  };
  const std::vector<Scenario> known = scenarios_of(problem, formulation, found, *best, bound);
  // A single one: the nominal measure, no cone, or a wedge that rotates with the base.
  if (problem.measure.kind == RiskMeasure::WorstCase && known.size() > 1) {
    options.worst_at = [&](const Configuration& at) {
      auto out = worst_encounters(problem, formulation, at, bound);
      for (WorstEncounter& worst : out) {
        worst.scenario.direction = moved_inside(worst.scenario.direction, known.front(), bound);
      }
      return out;
    };
  }
  return prover->prove_minimum(problem, known, enclosed, *best, options);
}

void state_bound(const MinimumBound& bound, Proof& proof) {
  proof.boxes += bound.boxes;
  const bool is_proven = bound.lower_bound > 0;
  if (is_proven && proof.status == ProofStatus::NotApplicable) {
    proof.statement = "proven: " + bound.statement;
  } else {
    proof.statement += "; " + bound.statement;
  }
  if (is_proven) proof.lower_bound = bound.lower_bound;
}

}  // namespace stillbase
