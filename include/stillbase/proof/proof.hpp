// A proof that nothing was missed: every solution of a small case problem, enclosed.
//
// The variables are the planner's: free joints, angle of the base about an axis, contact time; one
// to three of them. Branch and bound with interval arithmetic whose ends are rounded outwards. What
// is proven is proven of the model: the numbers of the robot and of the problem as the doubles that
// the planner uses. With the contact time free the model's target moves exactly as Euler's
// equations say, from the estimate as doubles; the planner's integration of them is within 1e-9 of
// that. Equations that vanish identically but for rounding (the out-of-plane ones of a planar
// robot) are left out; leaving an equation out can only add solutions.
//
// Inequalities (bounds of the base position, closing speed, which way the hand faces) exclude boxes
// at no point of which they hold; a solution of the equations at which they cannot be decided is
// listed as undecided.
//
// Limits on joint rates, singular values and clearances are not part of the equations: every
// enclosed solution is judged by them afterwards, at the middle of its box and not with intervals,
// by whoever asks for the proof. Solutions beyond the limits are counted in the statement, not
// listed.
//
// "Not applicable", with the reason: attitudes free about more than one axis (three variables by
// themselves), such limits without a judge, more than eight joints, equations that leave curves of
// solutions.
#pragma once

#include <functional>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// What the limits on rates, singular values and clearances say of a solution.
enum class WithinLimits { Yes, No, Undecided };

struct ProofOptions {
  /// Boxes looked at before the rest is called undecided; about 30 us each, 150 us with seven
  /// joints that move. A count, so that the answer is the same on every machine. Three free joints
  /// of a 7-joint arm have been seen to take 6000 to 70000.
  long max_boxes = 100000;
  double min_width = 1e-8;  ///< rad (times: of about a radian of the target): below, undecided
  StopCondition stop = {};  ///< what is left then is undecided
  /// Judges a solution by these limits; asked only about boxes of at most 1e-8 rad (s), the others
  /// are undecided. Empty: problems with such limits are not applicable.
  std::function<WithinLimits(const JointBox&)> judge = {};
};

/// The proof that belongs to a capture problem.
///
/// A case problem with as many equations as variables: all its solutions. A problem whose
/// equations leave freedom that its objective's zeros take up: all configurations at which the
/// objective vanishes, which are its global minima (lower bound zero). Where it vanishes nowhere,
/// that alone is said.
/// @throws InputError as encounter_model()
Proof prove(const CaptureProblem& problem, const ProofOptions& options = {});

}  // namespace stillbase
