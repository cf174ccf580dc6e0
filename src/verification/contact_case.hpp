// A contact as the simulation takes it, by `reference`.
#pragma once

#include <stillbase/simulation/after_contact.hpp>

#include "verification/recomputation.hpp"

namespace stillbase::verification {

/// @param motion null without a target
/// @param d direction of the impulse on the hand, unit, in B
/// @param speed_factor on the target's predicted velocities
ContactCase contact_case(const CaptureProblem& problem, const TargetMotion* motion,
                         const ContactEvent& event, const PostureResponse& response,
                         const Configuration& configuration, const Vector3d& d,
                         const Vector6d& Fbar, double speed_factor = 1);

}  // namespace stillbase::verification
