// From a capture problem to a plan: search, collision judgement, approach.
#pragma once

#include <functional>
#include <string>

#include <stillbase/capture/formulation.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase {

struct PlannerOptions {
  StopCondition stop;
  /// Called as work goes on with (what is being done, done, total); may be empty.
  std::function<void(const std::string&, int, int)> on_progress;
  /// Candidates whose approach is tried before giving up. Every try may cost a second.
  int max_approaches = 8;
};

/// Plans a capture.
///
/// Candidates are ranked by their worst case over the direction cone. A candidate is free of
/// collision when at the contact, and while the target comes in during the wait, nothing touches
/// but the hand and the contact feature. The chosen configuration is the first candidate that is
/// free of collision, keeps the problem's post-impact limits under its first controller and has an
/// approach; without any, the same without the post-impact limits (`verify` then says which one
/// fails); without any, the best one with the reason of its failure.
/// @return a plan in every case: `status` and `approach.status` say what holds
/// @throws InputError for a problem whose parts do not fit together
Plan make_plan(const CaptureProblem& problem, const PlannerOptions& options = {});

/// The impact at a configuration: impulse by the problem's contact law, then everything about it.
ImpactSummary predict_impact(const CaptureProblem& problem, const Formulation& formulation,
                             const Configuration& configuration);

}  // namespace stillbase
