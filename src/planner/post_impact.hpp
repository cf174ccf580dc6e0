// What the time after the impact makes of a candidate.
#pragma once

#include <string>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/simulation/after_contact.hpp>

namespace stillbase {

/// The limits of the problem that do not hold after the impact under the chosen controller: base
/// rate at the horizon, turn of the base, joint stops, rates and torques. Empty: all hold, or the
/// problem names no controller.
std::string post_impact_failure(const CaptureProblem& problem, const Configuration& configuration,
                                const ImpactSummary& impact, const StopCondition& stop);

/// The contact in a posture as the simulation takes it.
ContactCase contact_case(const CaptureProblem& problem, const Configuration& configuration,
                         const ImpactSummary& impact);

}  // namespace stillbase
