#include "app/start_impact.hpp"

#include <stillbase/encounter/encounter.hpp>

namespace stillbase::app {

Configuration start_configuration(const CaptureProblem& problem) {
  Configuration configuration;
  configuration.phi = problem.start;
  configuration.base = problem.base;
  configuration.contact_time = problem.variables.contact_time_lower;
  return configuration;
}

ImpactSummary start_impact(const CaptureProblem& problem) {
  return impact_at(problem, start_configuration(problem));
}

}  // namespace stillbase::app
