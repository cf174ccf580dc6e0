// Distances between bodies along the approach and at the contact, postures by `reference`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/collision/scene.hpp>

#include "verification/checks.hpp"
#include "verification/path_motion.hpp"

namespace stillbase::verification {

/// The smallest distance of two bodies over a time: at an instant, and proven over all of it.
struct LeastDistance {
  double found = kInfinity;   ///< m; <= 0: they overlap
  double proven = kInfinity;  ///< m, lower bound between the instants too
  double time = 0;            ///< s, of `found`
  std::string pair;           ///< of `found`
};

/// The smallest distance among pairs that may not touch.
struct PathClearance {
  bool complete = false;  ///< false: `detail` says why
  std::string detail;
  /// Along approach and wait. Infinite: there is no pair that could touch.
  LeastDistance least;
  /// The same without the hand's body against the target, as a plan states it.
  LeastDistance of_path;
  long instants = 0;  ///< number of postures that were looked at
  /// Without hand against target by the distances of `collision`, with steps of half the resolution
  /// in joint space (of the target in the wait), the instants at which a plan is made.
  std::optional<double> distance_as_stated;
  /// Smallest distances at the samples by the two codes: the largest difference, m.
  double difference_of_codes = 0;
  std::string differs_most;  ///< where
};

/// Along the approach and the wait. Every time between two samples is halved until no pair can come
/// closer within a part than the smallest distance found, less the options' gap: the distance in
/// the middle less the furthest that both shapes can move until either end. The problem's
/// resolution does not matter. Ends where shapes overlap: nothing smaller is looked for. Not
/// complete where a million instants do not decide.
/// @param tracks motion of the base between the samples
PathClearance path_clearance(const Context& context, const std::vector<BaseTrack>& tracks);
/// Along another path. @param target its motion over that time, or null
PathClearance path_clearance(const Context& context, const Approach& path,
                             const TargetMotion* target, const std::vector<BaseTrack>& tracks);

/// A pair of bodies in contact at a configuration, except the hand's body with the target near the
/// feature; empty: there is none.
std::optional<Proximity> contact_collision(const CaptureProblem& problem,
                                           const CollisionScene& scene,
                                           const Configuration& configuration);

}  // namespace stillbase::verification
