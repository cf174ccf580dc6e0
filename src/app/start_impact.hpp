// The impact that a problem states, taken in its start posture.
#pragma once

#include <stillbase/impact/summary.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase::app {

/// The start posture at the stated base pose and the earliest contact time.
Configuration start_configuration(const CaptureProblem& problem);

/// The impact there, by the problem's contact law.
ImpactSummary start_impact(const CaptureProblem& problem);

}  // namespace stillbase::app
