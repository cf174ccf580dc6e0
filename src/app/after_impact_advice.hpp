// What to change where no configuration keeps the limits after the impact.
#pragma once

#include <string>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase::app {

/// Changes of the problem that most likely help. Those of `post_impact` were simulated in the
/// plan's configuration, and what still fails with one is said; of a slower target and other
/// margins a new search has to tell.
/// @pre the plan's configuration exceeds a limit after the impact
std::string after_impact_advice(const Plan& plan, const StopCondition& stop);

}  // namespace stillbase::app
