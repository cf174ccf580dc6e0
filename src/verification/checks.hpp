// The sets of checks. Each adds its checks to the list; verify_plan() calls them in order.
#pragma once

#include <functional>
#include <optional>

#include <stillbase/simulation/after_contact.hpp>

#include "verification/claim_list.hpp"
#include "verification/objective.hpp"

namespace stillbase::verification {

/// What all checks share: the plan, and its configuration under the problem.
struct Context {
  const Plan& plan;
  const VerifyOptions& options;
  const Situation& situation;
  const CaptureProblem& problem;  ///< of the situation

  /// Directions of the cone before the local refinement.
  int cone_samples() const;
  double objective_tolerance() const;
};

/// Prepares a plan for its checks and runs them, unless the plan is not complete enough for that.
ClaimList check_plan(const Plan& plan, const VerifyOptions& options,
                     const std::function<void(const Context&, ClaimList&)>& checks);

/// Objections to the shape of the plan: sizes, numbers that are not finite. Other checks need none.
Objections structural_objections(const Plan& plan);

/// Joints, base, contact time and hand at one configuration.
void check_configuration(const Situation& situation, const VerifyOptions& options,
                         ClaimList& claims);

/// What the problem does not allow at a configuration: places, hand, margins, case; names of the
/// checks that fail.
std::vector<std::string> configuration_objections(const Situation& situation,
                                                  const VerifyOptions& options);

/// Closing speed, impulse, jump, momenta, case.
void check_impact(const Context& context, ClaimList& claims);

/// Objective and its worst case over the cone.
void check_objective(const Context& context, ClaimList& claims);

/// The cone that follows from the covariance of the target's estimate; beside a stated one whether
/// the plan warns where it is narrower.
void check_direction_cone(const Context& context, ClaimList& claims);

/// The plan's list of constraints, and collisions at the contact.
void check_constraints(const Context& context, ClaimList& claims);

void check_approach(const Context& context, ClaimList& claims);

/// Motion after the contact under every controller, and the fate of the target.
void check_post_impact(const Context& context, ClaimList& claims,
                       std::vector<ControllerReport>& reports);

/// The plan's account of the momentum after the contact and of the limits that it takes up, and the
/// problem's demands on grip and wheels. No check without a target.
/// @param run the motion under the first controller; null: there is none
void check_managed_momentum(const Context& context, const AfterContact* run, ClaimList& claims);

/// Whether the target bounces, is pushed on or is held, with which speed. No check without a target
/// or for a given impulse.
/// @param run the motion under the first controller; null: nothing was simulated, and only the
/// instantaneous impact can be judged
void check_target_fate(const Context& context, const AfterContact* run, ClaimList& claims);

}  // namespace stillbase::verification
