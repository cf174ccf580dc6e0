// A found path made better: smooth shifts of it, chosen by Ipopt.
//
// phi(u) = planned(u) + sum_k B_k(u) c_k, u in [0, 1] the part of the time of motion, B_k uniform
// cubic B-splines inside the interval: both ends, with rates and accelerations, stay. Unknown are
// the control points c_k and the factor on the time of motion. Momentum is conserved by
// construction (the base's motion is integrated); rates and accelerations are kept within limits
// and bodies apart by constraints at samples. What comes out is a proposal: it is checked as every
// path is, taken back half-way where the check refuses it, and dropped where it is no better.
#pragma once

#include <stillbase/core/interrupt.hpp>

#include "approach/attempt.hpp"

namespace stillbase {

/// Replaces a found motion by a better one in the sense of the problem's polish, if there is one,
/// and states the measure (s of motion, or rad of excursion) before and after.
void polish(const ApproachTask& task, double wait, const StopCondition& stop, AttemptResult& found);

}  // namespace stillbase
