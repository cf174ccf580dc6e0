// Reasons to refuse an approach before planning.
#pragma once

#include <optional>

#include "approach/task.hpp"

namespace stillbase {

/// An approach that was not found, and why.
Approach failed(ApproachStatus status, const std::string& detail);

/// Checks of start, goal, wait and the duration of the straight line. Nothing: planning may begin.
std::optional<Approach> refuse(const ApproachTask& task);

}  // namespace stillbase
