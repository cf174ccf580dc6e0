// The motion after the contact a second time, by `reference`.
#pragma once

#include "verification/checks.hpp"

namespace stillbase::verification {

/// Integrates the motion of a run by dense dynamics, control laws, contact, friction, stops and an
/// integrator of its own, and compares base, joints, velocities, the target of a compliant contact,
/// momentum of the wheels and the largest demanded torques with the run's. A held target is added
/// to the robot by the second code, too, and so are the errors of the controller's model.
///
/// Not verified, with the reason, where the run has what the second code lacks: two joints at their
/// stops at once, a joint at its rate limit under continuous control, or a target that the base
/// itself holds.
/// @param run of the controller, with a trace from the contact to the horizon
void check_own_motion(const Context& context, const std::string& controller,
                      const AfterContact& run, ClaimList& claims);

}  // namespace stillbase::verification
