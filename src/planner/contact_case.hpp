// The contact in a configuration as the simulation takes it.
#pragma once

#include <string>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/simulation/after_contact.hpp>

namespace stillbase {

ContactCase contact_case(const CaptureProblem& problem, const Configuration& configuration,
                         const ImpactSummary& impact);

/// The same of many configurations that meet one contact feature, by the encounter with it: to make
/// that takes longer than what follows.
ContactCase contact_case(const CaptureProblem& problem, const EncounterModel& model,
                         const Configuration& configuration, const ImpactSummary& impact);
/// post_impact_failure() in the same way.
std::string post_impact_failure(const CaptureProblem& problem, const EncounterModel& model,
                                const Configuration& configuration, const ImpactSummary& impact,
                                const StopCondition& stop);

}  // namespace stillbase
