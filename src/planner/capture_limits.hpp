// The momentum that a capture has to manage, and how much of each limit that takes.
#pragma once

#include <string>

#include <stillbase/plan/plan.hpp>
#include <stillbase/simulation/after_contact.hpp>

namespace stillbase {

/// @param subject the contact of this configuration
/// @param run under the first controller, finished; null: what takes no simulation
ManagedMomentum account_for_momentum(const CaptureProblem& problem,
                                     const Configuration& configuration,
                                     const ImpactSummary& impact, const ContactCase& subject,
                                     const AfterContact* run);

/// Whether the limit that is held longest under `detumble` binds: for at least half of the time
/// until robot and target rest, or to the horizon. A load that is near its limit for an instant
/// does not decide that time: the controller's gains do. Neither does a wheel's torque where that
/// time is more than 1.05 times `least_time`: the gains bring the joints to rest then, and stronger
/// wheels save little or nothing.
/// @param horizon of the simulation, s
bool is_bound(const ManagedMomentum& managed, double horizon);

/// Limits of grip and wheels: a capture that exceeds one is none. The other ones have criteria of
/// their own.
bool is_demand_on_grasp(const LimitUse& use);

/// Beyond what rounding leaves of a limit that is just kept.
inline bool is_exceeded(const LimitUse& use) { return use.part() > 1 + 1e-6; }

/// Momentum about an axis without a wheel.
bool has_no_wheel(const LimitUse& use);

/// "wheel momentum of y: 12.3 N m s of 10 N m s".
std::string limit_words(const LimitUse& use);

}  // namespace stillbase
