#include "app/start_impact.hpp"

#include <stillbase/planner/planner.hpp>

namespace stillbase::app {

Configuration start_configuration(const CaptureProblem& problem) {
  Configuration configuration;
  configuration.phi = problem.start;
  configuration.base = problem.base;
  configuration.contact_time = problem.variables.contact_time_lower;
  return configuration;
}

ImpactSummary start_impact(const CaptureProblem& problem) {
  // The contact law alone is wanted: a formulation for it must not ask that the problem can be
  // solved, or that there is anything to solve.
  CaptureProblem contact = problem;
  contact.variables.joints.assign(static_cast<std::size_t>(problem.robot.n()), true);
  contact.variables.base_attitude = AttitudeFreedom::Fixed;
  contact.variables.base_position = PositionFreedom::Fixed;
  contact.variables.contact_time_upper = contact.variables.contact_time_lower;
  contact.hand.constraint = HandConstraint::None;
  contact.constraints.impact_case = CaseConstraint::None;
  contact.objective = {ObjectiveTerm{}};  // none is asked for: nothing has to be simulated
  return predict_impact(contact, Formulation(contact), start_configuration(contact));
}

}  // namespace stillbase::app
