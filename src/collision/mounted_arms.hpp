// Arms on one base that stand in each other.
#pragma once

#include <optional>

#include <stillbase/collision/scene.hpp>

namespace stillbase {

/// Two links of different arms that overlap at the start posture. The scene alone does not see all
/// of them: shapes of one body are no pair of it, nor are those that reach the joint between them,
/// as the feet and shoulders of arms on one place do. Links of allowed_contacts do not count.
std::optional<Proximity> overlap_of_arms(const CaptureProblem& problem);

}  // namespace stillbase
