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
// "Not applicable", with the reason: attitudes free about more than one axis (three variables by
// themselves), joint rates, singular values and clearances as constraints, more than three joints
// that move during the impact where the equations ask for base or coupling part.
#pragma once

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase {

struct ProofOptions {
  /// Boxes looked at before the rest is called undecided; about 20 to 100 us each. A count, so
  /// that the answer is the same on every machine.
  long max_boxes = 50000;
  double min_width = 1e-8;  ///< rad (times: of about a radian of the target): below, undecided
  StopCondition stop = {};  ///< what is left then is undecided
};

/// The proof that belongs to a capture problem.
///
/// A case problem with as many equations as variables: all its solutions. A problem whose
/// equations leave freedom that its objective's zeros take up: all configurations at which the
/// objective vanishes, which are its global minima (lower bound zero). Where it vanishes nowhere,
/// that alone is said.
/// @param F wrench per unit of impulse in B at the stated base attitude and the first contact time
Proof prove(const CaptureProblem& problem, const Vector6d& F, const ProofOptions& options = {});

}  // namespace stillbase
