// What to change where no configuration keeps the limits after the impact.
#pragma once

#include <string>

#include <stillbase/plan/plan.hpp>

namespace stillbase::app {

/// Changes of the problem that most likely help, with what the chosen configuration needs: of full
/// wheels capacity and preset per axis, of grips the load, of controllers that are late the
/// horizon.
/// @pre the plan's configuration exceeds a limit after the impact
std::string after_impact_advice(const Plan& plan);

}  // namespace stillbase::app
