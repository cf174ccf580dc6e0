// The global minimum of a problem's measure, bounded from below.
//
// Branch and bound over the planner's variables (free joints, attitude of the base, contact time)
// with Taylor models whose remainders are rounded outwards. The guarantee is that of proof.hpp; the
// objective may vanish nowhere, and the measure may be a worst case or a mean. One to three
// variables: an attitude that is free altogether or within a cone counts three. It counts two where
// only the direction of the impulse in B matters: without a constraint on hand and station, with a
// nominal measure, or the worst case over a cone of impulses along stated directions of N. A
// variable that nothing depends on counts as none.
//
// Every measure is bounded over finitely many impulses:
//   worst case    at least the largest |y| over some directions of the cone
//   expectation   |y|^2 = sum w_s |y_s|^2 over the problem's samples
//   CVaR          at least sum v_s |y_s|^2 for any weights 0 <= v_s <= w_s / (1 - level) of sum one
//
// Constraints that are left out make the bound lower, never wrong; the statement names them.
// Configurations count as the planner counts them: the hand within 1e-9 m of its point, variables
// within 1e-9 of their bounds. With the contact time free the target moves exactly as Euler's
// equations say.
//
// Not bounded, with the reason: an attitude change after the impact that is simulated, samples of
// the posture, samples of the contact time where the time is free.
#pragma once

#include <string>
#include <vector>

#include <stillbase/plan/prover.hpp>

namespace stillbase {

/// Why the minimum of a capture problem cannot be bounded; empty: it can.
std::string minimum_objection(const CaptureProblem& problem);

/// A lower bound of the problem's measure over all configurations.
/// @param scenarios nominal measure: the nominal encounter; worst case: encounters along directions
/// of the cone, the more the better; a mean: all samples (draw_scenarios)
/// @param enclosed the problem's own proof: where it encloses all postures, only they are examined
/// @param best the least value of the problem's measure among its candidates, > 0
/// @pre minimum_objection() is empty
MinimumBound prove_minimum(const CaptureProblem& problem, const std::vector<Scenario>& scenarios,
                           const Proof& enclosed, double best, const MinimumOptions& options = {});

}  // namespace stillbase
