// The wrench through the grip a second time, as the rate of the target's momentum.
#pragma once

#include "verification/checks.hpp"

namespace stillbase::verification {

/// Compares the grip's wrench of a run with the rate of the held target's momentum about the hand:
/// accelerations by dense dynamics of `reference`, the momentum a little before and after each
/// sample, differences. Not verified where unknown forces act: joints with friction or at a stop.
/// No check where nothing is held.
void check_grip_load(const Context& context, const AfterContact& run, ClaimList& claims);

}  // namespace stillbase::verification
