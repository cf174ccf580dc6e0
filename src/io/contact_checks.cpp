// What a problem cannot ask of a sticking contact or a latch, and why.
#include <algorithm>

#include <fmt/format.h>

#include "io/problem_reader.hpp"

namespace stillbase::io {

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
  if (problem.measure.kind == RiskMeasure::WorstCase) {
    refuse("objective", "not-supported",
           "measure: 'worst_case' is that over a cone of directions: " + no_direction +
               "; use 'expectation' or 'cvar' over what is uncertain");
  }
  if (!is_latch) return;
  const bool turns =
      std::any_of(problem.objective.begin(), problem.objective.end(),
                  [](const ObjectiveTerm& t) { return row_of(t.quantity).is_simulated(); });
  if (turns) {
    refuse("objective", "not-supported",
           "attitude_turned: is simulated with the robot alone; after a latch it holds the target");
  }
  if (problem.constraints.coupling_singular_value_min > 0) {
    refuse("constraints", "not-supported",
           "coupling_singular_value_min: is that of the robot alone; after a latch it holds the "
           "target");
  }
}

}  // namespace stillbase::io
