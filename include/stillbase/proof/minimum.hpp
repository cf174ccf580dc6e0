// A proof that no configuration is better: the global minimum of a problem's measure, bounded from
// below.
//
// Branch and bound over the planner's variables (free joints, attitude of the base, contact time;
// one to three of them) with Taylor models whose rests are rounded outwards: the same guarantee as
// proof.hpp, for problems whose objective vanishes nowhere or whose measure is no predicted value.
// An attitude that is free altogether or within a cone counts three. Free altogether it counts two
// where only the direction of the impulse in B matters: nothing is asked of hand and station, and
// the measure is a predicted value, or the worst case over a cone of impulses along stated
// directions of N. Every measure is bounded over finitely many impulses:
//   worst case    at least the largest |y| over some directions of the cone
//   expectation   |y|^2 = sum w_s |y_s|^2 over the problem's samples
//   CVaR          at least sum v_s |y_s|^2 for any weights 0 <= v_s <= w_s / (1 - level) of sum one
//
// A variable that nothing depends on counts as none. Constraints that are left out make the bound
// lower, never wrong: the statement names them. Configurations count as the planner counts them:
// the hand within 1e-9 m of its point, variables within 1e-9 of their bounds. With the contact time
// free the target moves exactly as Euler's equations say.
//
// Not bounded, with the reason: a turn after the impact that is simulated, samples of the posture,
// samples of the contact time where the time is free.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/plan/scenario.hpp>

namespace stillbase {

struct MinimumOptions {
  double relative_gap = 1e-3;  ///< of the best known value: good enough
  /// Boxes looked at, about 100 us each with three joints; of more joints, or of means over many
  /// samples, fewer, for each costs more. A count, so that the answer is the same on every machine.
  long max_boxes = 400000;
  StopCondition stop = {};  ///< the bound that was reached counts
  std::function<void(long boxes)> on_progress = {};
  /// The measure at a configuration, infinite where a constraint is violated. Where it is below the
  /// best value by more than the gap the proof ends: that one is better. May be empty.
  std::function<double(const Configuration&)> value_at = {};
};

/// What a bound says, in words and numbers.
struct MinimumBound {
  std::string statement;   ///< what was proven, or what was not, without "proven: "
  double lower_bound = 0;  ///< of the problem's measure, in its unit; zero: nothing was found out
  double gap = 0;          ///< best candidate's measure minus the lower bound
  long boxes = 0;          ///< looked at
  bool limit_reached = false;  ///< of boxes or by the stop condition
  /// Where a search should look again: a better configuration that turned up, or, where the limit
  /// was reached, those of which least is known.
  std::vector<Configuration> suspects;
};

/// Why the minimum of a capture problem cannot be bounded; empty: it can.
std::string minimum_objection(const CaptureProblem& problem);

/// The bound that belongs to a capture problem, in words and numbers.
/// @param scenarios as predicted: the predicted encounter; over a cone: encounters along directions
/// of it (everything else as predicted), the more the better; a mean: all samples (draw_scenarios)
/// @param enclosed the problem's own proof: where all postures are enclosed, only they are looked
/// at
/// @param best the least value of the problem's measure among its candidates, > 0
/// @pre minimum_objection() is empty
MinimumBound prove_minimum(const CaptureProblem& problem, const std::vector<Scenario>& scenarios,
                           const Proof& enclosed, double best, const MinimumOptions& options = {});

}  // namespace stillbase
