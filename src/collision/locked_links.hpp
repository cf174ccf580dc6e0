// Links behind locked joints that stand in what they are merged with.
#pragma once

#include <optional>

#include <stillbase/collision/scene.hpp>
#include <stillbase/robot/unlocked_robot.hpp>

namespace stillbase {

/// Two links of one body that overlap, or one and an obstacle fixed to it, which only locked joints
/// hold together. The scene of a problem does not see them: shapes of one body are no pair of it.
/// Pairs are those of a scene in which these joints are not locked, allowed_contacts included. That
/// nothing moves one against the other is why they need no clearance: a folded arm rests on
/// supports, a closed gripper on itself.
/// @param unlocked the problem's robot before the lock, as read_problem() gives it
std::optional<Proximity> overlap_of_locked_links(const CaptureProblem& problem,
                                                 const UnlockedRobot& unlocked);

}  // namespace stillbase
