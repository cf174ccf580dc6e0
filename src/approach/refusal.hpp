// What can be refused before any planning.
#pragma once

#include <optional>

#include "approach/task.hpp"

namespace stillbase {

/// An approach that was not found, and why.
Approach failed(ApproachStatus status, const std::string& detail);

/// Start, goal, the wait and the time that even a straight line needs do not depend on the path.
/// Nothing: planning may begin.
std::optional<Approach> refuse(const ApproachTask& task);

}  // namespace stillbase
