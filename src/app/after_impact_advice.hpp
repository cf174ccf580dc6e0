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
/// @param failure what post_impact_failure() says of it
std::string after_impact_advice(const Plan& plan, const std::string& failure,
                                const StopCondition& stop);

/// What the plan's configuration exceeds after the impact: `failure`, or where that is a limit of
/// the base every one of these, by how much.
std::string after_impact_words(const Plan& plan, const std::string& failure,
                               const StopCondition& stop);

}  // namespace stillbase::app
