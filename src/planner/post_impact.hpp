// Whether a candidate keeps the limits after the impact.
#pragma once

#include <string>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/simulation/after_contact.hpp>

namespace stillbase {

/// The limits of the problem that do not hold after the impact under the chosen controller: base
/// rate at the horizon, attitude change of the base, joint stops, rates and torques. Empty: all
/// hold, or the problem names no controller.
std::string post_impact_failure(const CaptureProblem& problem, const Configuration& configuration,
                                const ImpactSummary& impact, const StopCondition& stop);

/// The contact at a configuration, as input of the simulation.
ContactCase contact_case(const CaptureProblem& problem, const Configuration& configuration,
                         const ImpactSummary& impact);

}  // namespace stillbase
