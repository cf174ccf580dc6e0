// The approach: how the robot gets from its start posture to the chosen configuration, at rest and
// in time, and waits there for the target.
//
// Assumptions. The robot is at rest with zero momentum before the approach and while it waits.
// Base `held`: the base pose is that of the configuration throughout. Base `floating` with a free
// station: Omega = -H_b^-1 H_bphi phidot along the path; the net motion g(path) of the base does
// not depend on where it starts, so the start pose is goal.base * g(path)^-1. Between the stored
// samples the joints follow cubic Hermite segments; limits, clearances and base poses hold for
// those segments, not only at the samples. Joints that the search may not change, and that are
// already where they should be, stay still. Continuous joints end at the configuration's angle; the
// start angle is taken the whole turns away from problem.start that make the way shortest.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/target/target.hpp>

namespace stillbase {

/// Plans the approach to a configuration: OMPL path against FCL distances, simplification, corners
/// rounded, time law within rate and acceleration limits, then robot(t) against target(t) along the
/// whole motion and the wait. What was found is checked again as it is stored; a path that is hit
/// is planned anew a bounded number of times (other random stream, with the target's poses during
/// the motion as further obstacles, on a finer grid, with a longer wait).
///
/// @param goal posture and base pose at the contact, and the contact time
/// @param target predicted motion, or null: nothing but robot and obstacles. A target that is met
/// at
///   a stated direction is given as the motion that brings it to the hand at the contact time.
/// @param seed every random choice follows from it; same seed, same bytes
/// @param stop asked during planning; reached: TimeOut
/// @param solver_calls counts the planner's runs under its name
/// @return status Found with every field set, or what failed with `detail` in words:
///   NotRequested (approach switched off), StartInvalid, GoalInvalid (limits or bodies closer than
///   the clearance), GoalUnreachable (no path found), HitEarly (who, whom, when), TimeOut, TooSlow
///   (by how many seconds).
/// @throws std::invalid_argument for sizes that do not fit, numbers that are not finite, limits
/// that
///   are not positive, or an unknown planner
[[nodiscard]] Approach plan_approach(const CaptureProblem& problem, const Configuration& goal,
                                     const TargetMotion* target, std::uint64_t seed,
                                     const StopCondition& stop,
                                     std::map<std::string, long>& solver_calls);

/// Names accepted in ApproachSpec::planner.
std::vector<std::string> approach_planner_names();

}  // namespace stillbase
