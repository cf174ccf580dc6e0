// The motion after the impact in a configuration of a problem.
#pragma once

#include <string>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/simulation/after_contact.hpp>

namespace stillbase {

/// Simulates from the contact to the horizon by the problem's `post_impact` section, with adaptive
/// steps.
/// @param impact of this configuration, as impact_at() or a plan has it
/// @param controller a name of controller_names()
/// @throws std::invalid_argument for another name; else as simulate_after_contact()
[[nodiscard]] AfterContact simulate_post_impact(const CaptureProblem& problem,
                                                const Configuration& configuration,
                                                const ImpactSummary& impact,
                                                const std::string& controller,
                                                const StopCondition& stop = {});

/// What the joints do after the horizon of simulate_post_impact() under this controller.
/// @return nothing when a simulation did not finish, for a controller of another name, and for a
///   contact that cannot be simulated
[[nodiscard]] std::optional<AfterHorizon> motion_after_horizon(const CaptureProblem& problem,
                                                               const Configuration& configuration,
                                                               const ImpactSummary& impact,
                                                               const std::string& controller,
                                                               const StopCondition& stop = {});

/// What a plan states of the time after its impact.
struct AfterImpactAccount {
  /// motion_after_horizon() under the problem's first controller, but for rounding: slow motions
  /// are integrated by fixed steps.
  std::optional<AfterHorizon> motion;
  /// The momentum after the contact, what it takes to manage it under the problem's first
  /// controller, and how much of each limit is used. Nothing for a problem without a target.
  std::optional<ManagedMomentum> momentum;
};
/// Both by one simulation.
/// @param impact of this configuration, as impact_at() or a plan has it
/// @throws as simulate_after_contact()
[[nodiscard]] AfterImpactAccount account_after_impact(const CaptureProblem& problem,
                                                      const Configuration& configuration,
                                                      const ImpactSummary& impact,
                                                      const StopCondition& stop = {});

/// The first limit of the problem that is exceeded after the impact under its first controller:
/// grip and momentum of the wheels, joint stops, base rate at the horizon, attitude change, joint
/// rates and torques, and under detumble the horizon. Empty: none, or the problem names no
/// controller.
std::string post_impact_failure(const CaptureProblem& problem, const Configuration& configuration,
                                const ImpactSummary& impact, const StopCondition& stop);

/// Whether a path was found, or none was asked for.
inline bool arrives(const Approach& approach) {
  return approach.status == ApproachStatus::Found ||
         approach.status == ApproachStatus::NotRequested;
}

/// post_impact_failure() of the chosen configuration. Empty for a plan without solution or path,
/// too.
std::string post_impact_failure(const Plan& plan, const StopCondition& stop = {});

}  // namespace stillbase
