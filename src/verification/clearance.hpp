// Distances between bodies along the approach and at the contact, postures by `reference`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/collision/scene.hpp>

#include "verification/checks.hpp"

namespace stillbase::verification {

/// The smallest distance among pairs that may not touch.
struct PathClearance {
  bool complete = false;           ///< false: `detail` says why
  std::optional<double> distance;  ///< m; empty: there is no pair that could touch
  /// The same without the hand's body against the target, as a plan states it.
  std::optional<double> distance_of_path;
  /// The same with steps of half the resolution in joint space (of the target in the wait), the
  /// instants at which a plan is made.
  std::optional<double> distance_as_stated;
  double time = 0;     ///< s
  std::string detail;  ///< the pair
  long instants = 0;   ///< number of postures that were checked
};

/// Along the approach and the wait, at steps of a part of the problem's resolution.
/// @param poses integrated base poses at the samples
PathClearance path_clearance(const Context& context, const std::vector<Pose>& poses);

/// A pair of bodies in contact at a configuration, except the hand's body with the target near the
/// feature; empty: there is none.
std::optional<Proximity> contact_collision(const CaptureProblem& problem,
                                           const CollisionScene& scene,
                                           const Configuration& configuration);

}  // namespace stillbase::verification
