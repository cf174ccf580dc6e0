// Every solution of a small case problem, enclosed.
//
// Branch and bound with interval arithmetic over the planner's variables: free joints, angle of the
// base about an axis, contact time; one to three of them. Interval ends are rounded outwards.
//
// The equations carry the planner's tolerance: a configuration that the planner takes for a
// solution is at an enclosed one or in an undecided box. Solutions that the tolerance does not tell
// apart, nearly double ones, are undecided.
//
// The proof holds for the model: for the numbers of robot and problem as the doubles that the
// planner uses. With the contact time free the model's target moves exactly as Euler's equations
// say; the planner's integration of them is within 1e-9 of that. Equations that vanish identically
// but for rounding (the out-of-plane ones of a planar robot) are left out, which can only add
// solutions.
//
// Inequalities (bounds of the base position, closing speed, the side that the hand faces) exclude
// boxes at no point of which they hold. A solution of the equations at which they cannot be decided
// is listed as undecided.
//
// Limits on joint rates, singular values and clearances are not part of the equations. Whoever asks
// for the proof judges every solution by them, at the middle of its box and not with intervals.
// Solutions beyond the limits are counted in the statement, not listed.
//
// "Not applicable", with the reason: attitudes free about more than one axis (three variables by
// themselves), such limits without a judge, more than eight joints, equations that leave curves of
// solutions.
#pragma once

#include <stillbase/plan/prover.hpp>

namespace stillbase {

/// The proof that belongs to a capture problem.
///
/// A case problem with as many equations as variables: all its solutions. A problem whose
/// equations leave freedom that the zeros of its objective take up: all configurations at which the
/// objective vanishes, its global minima (lower bound zero), or that there are none.
/// @throws InputError as encounter_model()
Proof prove(const CaptureProblem& problem, const ProofOptions& options = {});

/// Makes the functions of this library the prover of all planners of this program. Linking the
/// library alone does not: a static library is not asked for what nobody calls.
void enable_proofs();

}  // namespace stillbase
