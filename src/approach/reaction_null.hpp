// Paths within the angular reaction null space: the arm moves and the base does not turn.
//
// phi' = P(phi) w, P the projector onto the null space of Htilde_omegaphi (9). The directions that
// are open change with the posture, so that postures off the null space of the start are reached by
// going around (n > rank + 1). The path follows a reference curve as well as it may,
//   phi' = P(phi) (r' + kappa (r - phi)),
// and the knots of the curve are shifted by Newton steps of least norm until it ends at the goal.
#pragma once

#include <vector>

#include "approach/attempt.hpp"

namespace stillbase {

/// Each curve is first brought to any posture that solves the contact, then its end is moved to
/// better ones as far as the curve can be bent. Of several curves the one with the best end is
/// kept. References are the straight line, then ever wider detours. When all of these collide, they
/// are paths around the obstacles that OMPL finds over joint velocities within the null space.
/// @param goals as try_approach; @param scenes one per goal
/// @param result its `end`, or status and detail when there is no curve
/// @return curve over its length (rad), slopes of norm 1, to goal `reached`; empty: none
JointPath plan_null_path(const std::vector<const AttemptGoal*>& goals,
                         const std::vector<StillScene>& scenes, std::uint64_t seed,
                         const StopCondition& stop, AttemptResult& result, std::size_t& reached);

}  // namespace stillbase
