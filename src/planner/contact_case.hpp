// The contact in a configuration as the simulation takes it.
#pragma once

#include <stillbase/plan/plan.hpp>
#include <stillbase/simulation/after_contact.hpp>

namespace stillbase {

ContactCase contact_case(const CaptureProblem& problem, const Configuration& configuration,
                         const ImpactSummary& impact);

}  // namespace stillbase
