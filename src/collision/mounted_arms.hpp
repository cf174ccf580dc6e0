// Arms on one base that stand in each other, or in the base.
#pragma once

#include <optional>

#include <stillbase/collision/scene.hpp>

namespace stillbase {

/// Two links of different arms that overlap at the start posture. The scene alone does not see all
/// of them: shapes of one body are no pair of it, nor are those that reach the joint between them,
/// as the feet and shoulders of arms on one place do. Links of allowed_contacts do not count.
std::optional<Proximity> overlap_of_arms(const CaptureProblem& problem);

/// A link of an arm that stands in the satellite at the start posture: the middle of a shape of the
/// link lies in a shape of the satellite. Of the links that the scene leaves out, since they belong
/// to the satellite or reach the joint on it: a foot may be let in to half its depth.
std::optional<Proximity> sunk_link(const CaptureProblem& problem);

}  // namespace stillbase
