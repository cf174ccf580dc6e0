// From a capture problem to a plan: search, collision judgement, approach.
#pragma once

#include <functional>
#include <string>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/plan/prover.hpp>

namespace stillbase {

struct PlannerOptions {
  StopCondition stop;
  /// Called as work goes on with (what is being done, done, total); may be empty.
  std::function<void(const std::string&, int, int)> on_progress;
  /// Candidates whose approach is tried before giving up. Every try may cost a second.
  int max_approaches = 8;
  /// Candidates are good when their objective is at most this factor times the best one's, >= 1:
  /// the approach goes for all of them at once.
  double goal_factor = 1.1;
  /// Proves what the search found; null: plans say that there is no proof.
  const Prover* prover = registered_prover();
  int goal_samples = 8;  ///< tries for further goals, as good, on the self-motion at the contact
};

/// Plans a capture.
///
/// Candidates are ranked by their worst case over the direction cone. A candidate is free of
/// collision when at the contact, and while the target comes in during the wait, nothing touches
/// but the hand and the contact feature. The good ones that are free of collision and keep the
/// problem's post-impact limits under its first controller are gone for at once (`goal_factor`);
/// when none of them is reached, together with samples of their self-motion at the contact
/// (`goal_samples`; a sample that is reached becomes the last candidate, reached by no start,
/// certified as what it is). When none is reached, candidates are tried one by one: those that keep
/// the limits, then the other ones
/// (`verify` then says which limit fails); without any, the best one stands with the reason of its
/// failure. A floating base that starts as stated has its candidates tried one by one.
/// Without an approach asked for, its status is GoalInvalid when no candidate is free of collision.
/// @return a plan in every case: `status` and `approach.status` say what holds
/// @throws InputError for a problem whose parts do not fit together
Plan make_plan(const CaptureProblem& problem, const PlannerOptions& options = {});

}  // namespace stillbase
