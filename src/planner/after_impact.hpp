// The limits of the time after the impact, of many configurations.
#pragma once

#include <string>
#include <vector>

#include <stillbase/encounter/encounter.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/simulation/after_contact.hpp>
#include <stillbase/simulation/simulate.hpp>

namespace stillbase {

/// As precise as limits are judged by.
SimulationOptions judging_options(const CaptureProblem& problem, const StopCondition& stop);

/// The whole motion to the horizon, as precise as judging_options() ask for.
AfterContact motion_to_horizon(const CaptureProblem& problem, const ContactCase& subject,
                               const Controller& controller, const StopCondition& stop);

/// How many configurations are simulated in about the time of one: several side by side where a
/// first run may be certain of what follows, else 1.
int simulated_together(const CaptureProblem& problem);

/// post_impact_failure() of configurations that meet one contact feature, simulated side by side.
/// @param model the encounter with that feature: to make it takes longer than what follows
/// @param impacts one per configuration
/// @return exclusion::kNotJudged for what is not known when the stop is reached
std::vector<std::string> post_impact_failures(const CaptureProblem& problem,
                                              const EncounterModel& model,
                                              const std::vector<Configuration>& configurations,
                                              const std::vector<ImpactSummary>& impacts,
                                              const StopCondition& stop);

}  // namespace stillbase
