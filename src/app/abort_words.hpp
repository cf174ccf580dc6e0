// What becomes of robot and target if the grasp of a hand that moves does not close.
#pragma once

#include <string>

#include <stillbase/plan/plan.hpp>

namespace stillbase::app {

/// "stops within 3.7 s if the grasp does not close, ...": where the robot comes to rest beside the
/// feature, and when the feature's plane reaches the hand there.
/// @pre the plan has such a path, and a target
std::string abort_words(const Plan& plan);

}  // namespace stillbase::app
