// Variables, side conditions and impulses of a lower bound.
#include "proof/minimum_problem.hpp"

#include <algorithm>

namespace stillbase::proof {
namespace {

/// Whether wrench or hand point change with the base attitude.
bool depends_on_attitude(const ZeroProblem& where) {
  const VariableEncounter& encounter = where.encounter;
  const bool is_point_in_base = encounter.hand_point && encounter.hand_frame == Frame::Base;
  return encounter.frame != ContactFrame::Base || (where.has_hand_point && !is_point_in_base);
}

/// Whether of a free attitude only the direction of the impulse in B counts, so that rotations
/// about that direction change nothing.
bool counts_by_direction(const CaptureProblem& problem, const ZeroProblem& where) {
  const VariableEncounter& encounter = where.encounter;
  const auto is_position = [](const SideCondition& side) {
    return side.kind == SideKind::BasePosition;
  };
  if (problem.variables.base_attitude != AttitudeFreedom::Free || encounter.time_is_free ||
      !encounter.moment.isZero(0) || where.has_hand_point || where.has_hand_axis ||
      where.has_hand_axes ||
      std::any_of(where.side_conditions.begin(), where.side_conditions.end(), is_position)) {
    return false;
  }
  if (problem.measure.kind == RiskMeasure::Nominal) return true;
  // A cone is symmetric about its axis; the law of the impulse has to be, too.
  return problem.measure.kind == RiskMeasure::WorstCase && !problem.uncertainty.cone_plane_normal &&
         encounter.frame == ContactFrame::Inertial &&
         problem.impulse.source != ImpulseSource::RigidBody;
}

/// Target and E as it is nominally, relative to each other where the target is ahead of its nominal
/// motion: it has turned.
ContactKinematics<double> contact_in_E(const VariableEncounter& encounter, double time_offset) {
  ContactKinematics<double> out;
  if (encounter.follows_target() && !encounter.time_is_free) {
    out = contact_kinematics<double>(encounter, encounter.R_NT, encounter.time_lower + time_offset);
  }
  if (encounter.time_is_free || time_offset == 0) out.R_EB.setIdentity();
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

}  // namespace

MinimumProblem minimum_problem(const CaptureProblem& problem,
                               const std::vector<Scenario>& scenarios) {
  MinimumProblem out;
  out.where = zero_problem(problem);
  VariableEncounter& encounter = out.where.encounter;
  if (encounter.num_attitudes() > 0 && !depends_on_attitude(out.where)) {
    encounter.attitude_is_free = false;
    encounter.turn_basis.clear();
    out.where.side_conditions.clear();
  }
  if (!encounter.spin) encounter.time_is_free = false;
  if (!encounter.turn_basis.empty() && counts_by_direction(problem, out.where)) {
    // Rotations about axes across it bring it into every direction.
    encounter.turn_basis = {encounter.u, encounter.v};
    for (Vector3d& axis : encounter.turn_basis) {
      if (encounter.frame == ContactFrame::Target) axis = encounter.R_NT * axis;
    }
  }
  for (SideCondition& side : out.where.side_conditions) {
    side.lower -= out.tolerances.feasible;
    side.upper += out.tolerances.feasible;
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
