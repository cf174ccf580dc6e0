// What a page draws of a robot, a problem and a plan beside what their files say.
#pragma once

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>

#include "io/json.hpp"

namespace stillbase::app {

/// Chain, shapes and hand of a robot. Lengths in m, joints in rad (m); a pose is
/// [x, y, z, qw, qx, qy, qz]. The page moves the chain by itself (web/src/kinematics.js).
///
/// `joints` are those that move by themselves, in the order of all postures. `tree` says what moves
/// each of `bodies`: its parent (-1: the base), the joint's pose there at zero, the number of the
/// joint, and where the body follows another one `ratio` and `offset` (1 and 0 without them):
/// position = ratio * joint + offset.
///
/// Beside it the page draws `visuals` (page_visuals.hpp) instead of the shapes of the same links.
io::Json robot_scene(const RobotModel& robot);

/// A robot alone: all joints at zero, or at the limit that is nearest to it.
io::Json lone_robot_scene(const RobotModel& robot);

/// The robot, its start posture, target and obstacles, and the nominal motion of the target over
/// the window of contact times (where that is one instant, 10 s around it).
io::Json problem_scene(const CaptureProblem& problem);

/// That of the problem, and: the target along the approach and at every candidate's contact, hand
/// distance and closing speed, momenta, clearance, the motion after the impact under every
/// controller of the problem, and what robust and nominal optimum make of other directions.
/// @param stop ends the simulations early
io::Json plan_scene(const Plan& plan, const StopCondition& stop);

}  // namespace stillbase::app
