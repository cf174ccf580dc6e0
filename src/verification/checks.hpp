// The groups of claims. Each adds its claims to the list; verify_plan() calls them in order.
#pragma once

#include <optional>

#include <stillbase/simulation/after_contact.hpp>

#include "verification/claim_list.hpp"
#include "verification/recomputation.hpp"

namespace stillbase::verification {

/// What all checks share: the plan, and what the problem alone decides.
struct Context {
  const Plan& plan;
  const CaptureProblem& problem;
  const VerifyOptions& options;
  const TargetMotion* motion = nullptr;  ///< null without a target
};

/// Objections to the shape of the plan: sizes, numbers that are not finite. Other checks need none.
std::vector<std::string> structural_objections(const Plan& plan);

void check_configuration(const Context& context, const ContactEvent& event,
                         const PostureResponse& response, ClaimList& claims);

/// Impulse, jump, momenta, case.
void check_impact(const Context& context, const ContactEvent& event,
                  const PostureResponse& response, ClaimList& claims);

/// Objective and its worst case over the cone.
void check_objective(const Context& context, const ContactEvent& event,
                     const PostureResponse& response, ClaimList& claims);

/// The cone that follows from the covariance of the target's estimate; no claim for a stated one.
void check_direction_cone(const Context& context, ClaimList& claims);

/// The list of constraints and what the certificate says of them.
void check_constraints(const Context& context, const ContactEvent& event,
                       const PostureResponse& response, ClaimList& claims);

/// What the objective is worth at a configuration, by `reference`.
struct ObjectiveNumbers {
  double nominal = 0;
  double worst_case = 0;  ///< largest of the sampled directions
  double measure = 0;     ///< of the problem
  double scale = 0;       ///< size of the terms that the nominal value is a sum and difference of
};
ObjectiveNumbers objective_numbers(const Context& context, const Configuration& at);

/// All candidates, and that the configuration is one of them and touches nothing.
void check_candidates(const Context& context, ClaimList& claims);

/// What the problem does not allow at a configuration: places, hand, margins, case; by name.
std::vector<std::string> configuration_objections(const Context& context, const Configuration& at,
                                                  const ContactEvent& event,
                                                  const PostureResponse& response);

/// Points, lengths and ends of the curves of solutions; no claim without any.
void check_families(const Context& context, ClaimList& claims);

/// Configurations of the plan that are on a curve of solutions which it does not list. Of a robust
/// measure what the prediction alone would choose: its own minima may be on curves where no start
/// ended.
std::vector<std::string> unlisted_curves(const Context& context);

/// The enclosed solutions and the candidates are the same; nothing where there is no proof.
void check_proof(const Context& context, ClaimList& claims);

/// The lower bound of the measure, when it is above zero: no candidate and no configuration that a
/// search of its own finds is better.
void check_bound(const Context& context, ClaimList& claims);

/// Torques along the approach against the effort limits, and as stated.
void check_torques(const Context& context, ClaimList& claims);

/// Bounds of the constraints, list and admissibility of the candidates, record of the search.
void check_consistency(const Context& context, ClaimList& claims);

void check_approach(const Context& context, ClaimList& claims);

/// Motion after the contact under every controller, and the fate of the target.
void check_post_impact(const Context& context, const ContactEvent& event,
                       const PostureResponse& response, ClaimList& claims,
                       std::vector<ControllerReport>& reports);

/// Bounced, pushed on or held, with which speed. No claim without a target or for a given impulse.
/// @param run the motion under the first controller; null: nothing was simulated, and only the
/// instantaneous impact can be judged
void check_target_fate(const Context& context, const ContactEvent& event,
                       const PostureResponse& response, const Vector6d& Fbar,
                       const AfterContact* run, ClaimList& claims);

}  // namespace stillbase::verification
