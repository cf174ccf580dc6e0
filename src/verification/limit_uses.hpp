// What is used of every limit after the contact, by the second code.
#pragma once

#include <map>
#include <vector>

#include "verification/checks.hpp"

namespace stillbase::verification {

/// The largest use of each limit, by place.
using LimitUses = std::map<CaptureLimit, std::vector<LimitUse>>;

/// @param run the motion under the first controller; null: what is known without it
/// @pre the problem has a target
LimitUses limit_uses(const Situation& situation, const AfterContact* run);

}  // namespace stillbase::verification
