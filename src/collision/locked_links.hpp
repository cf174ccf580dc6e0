// Links behind locked joints that stand in what they are merged with.
#pragma once

#include <optional>

#include <stillbase/collision/scene.hpp>
#include <stillbase/robot/unlocked_robot.hpp>

namespace stillbase {

/// A link that locked joints hold on the base and that overlaps the base, or an obstacle fixed to
/// it. The scene of a problem does not see it: shapes of one body are no pair of it. Pairs are
/// those of a scene in which these joints are not locked, allowed_contacts included. They need no
/// clearance, since nothing moves one against the other, and locked links may overlap each other:
/// a folded arm rests on itself, and so do the jaws of a closed gripper.
/// @param unlocked the problem's robot before the lock, as read_problem() gives it
std::optional<Proximity> overlap_of_locked_links(const CaptureProblem& problem,
                                                 const UnlockedRobot& unlocked);

}  // namespace stillbase
