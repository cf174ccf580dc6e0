// Improves a found path by Ipopt, path and time law together, see polish_problem.hpp. The result is
// checked like every path, taken in part where the check refuses it, and dropped where it is no
// better.
#pragma once

#include <stillbase/core/interrupt.hpp>

#include "approach/attempt.hpp"

namespace stillbase {

/// Replaces a found motion by a better one in the sense of the problem's polish, if there is one,
/// and states the measure (s of motion, or rad of excursion) before and after.
void polish(const ApproachTask& task, double wait, const StopCondition& stop, AttemptResult& found);

}  // namespace stillbase
