// A found motion as the plan states it.
#pragma once

#include "approach/attempt.hpp"

namespace stillbase {

/// @param attempt Found; @param tries attempts that it took; @param wait s at rest before the
/// contact
Approach finished(const ApproachTask& task, const AttemptResult& attempt, int tries, double wait);

}  // namespace stillbase
