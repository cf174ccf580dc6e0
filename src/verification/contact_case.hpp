// From a contact to its simulation, and from the simulation to limits.
#pragma once

#include <stillbase/simulation/after_contact.hpp>

#include "verification/recomputation.hpp"

namespace stillbase::verification {

/// A contact as the simulation takes it, by `reference`.
/// @param motion null without a target
/// @param d direction of the impulse on the hand, unit, in B
/// @param speed_factor on the target's predicted velocities
/// @param velocity_error added to them after that, [v; omega] at the hand, in B
ContactCase contact_case(const CaptureProblem& problem, const TargetMotion* motion,
                         const ContactEvent& event, const PostureResponse& response,
                         const Configuration& configuration, const Vector3d& d,
                         const Vector6d& Fbar, double speed_factor = 1,
                         const Vector6d& velocity_error = Vector6d::Zero());

/// Largest fraction of a joint's limit that peaks (n) use; 0 without limits.
double largest_fraction(const RobotModel& robot, const JointVectord& peaks, double Joint::*limit);

}  // namespace stillbase::verification
