// From one attempt to the next.
#pragma once

#include "approach/attempt.hpp"

namespace stillbase {

/// The first attempt: as the problem says, the target a still obstacle where it is at the arrival.
AttemptOptions first_options(const ApproachTask& task);

/// What the next attempt does differently, beside its random stream.
/// @param attempt number of the one that failed with `result`, from 1 on
void learn(const ApproachTask& task, const AttemptResult& result, int attempt,
           AttemptOptions& options);

/// What to report when every attempt fails: a hit rather than being late, the least delay.
bool is_better_news(const AttemptResult& result, const AttemptResult& known);

}  // namespace stillbase
