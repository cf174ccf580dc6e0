// Options of the next attempt after one that failed.
#pragma once

#include "approach/attempt.hpp"

namespace stillbase {

/// The first attempt: as the problem says, the target a still obstacle where it is at the arrival.
AttemptOptions first_options(const ApproachTask& task);

/// Options of the next attempt, which also has another random stream.
/// @param attempt number of the one that failed with `result`, from 1 on
void adjust_options(const ApproachTask& task, const AttemptResult& result, int attempt,
                    AttemptOptions& options);

/// Whether a failure explains more than the known one: a collision more than a delay, then the
/// least delay.
bool explains_more(const AttemptResult& result, const AttemptResult& known);

}  // namespace stillbase
