// The contact in a configuration as the simulation takes it.
#pragma once

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

}  // namespace stillbase
