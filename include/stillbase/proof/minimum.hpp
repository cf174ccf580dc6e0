// A proof that no posture is better: the global minimum of a problem's measure, bounded from below.
//
// Branch and bound over the free joints with quadratic forms whose rests are rounded outwards: the
// same guarantee as proof.hpp, for problems whose objective vanishes nowhere or whose measure is a
// worst case. Over a cone the worst case is at least the largest value over finitely many of its
// directions, so a bound of that is a bound of the worst case.
//
// Assumptions: base attitude, base position and contact time fixed, one to three free joints, the
// same encounter at every posture. Constraints that are left out make the bound lower, never wrong:
// the statement names them. Postures count as the planner counts them: the hand within 1e-9 m of
// its point, joints within 1e-9 of their limits.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// An impulse that the robot may be hit by.
struct ImpulseCase {
  Vector6d F = Vector6d::Zero();  ///< wrench on the hand per unit of impulse, in B
  /// p = numerator / (F' W_h F + target_inverse_mass), the numerator (1+e) v_n; of a given impulse
  /// p itself.
  double numerator = 1;
  std::optional<double> target_inverse_mass;  ///< n' W_t n, 1/kg; empty: the impulse is given
};

/// What is bounded: the largest |y| over the impulses, y the terms of the objective below each
/// other, each divided by its size.
struct MinimumProblem {
  RobotModel robot;
  JointVectord start;                ///< n, positions of the joints that are not free
  std::vector<int> free;             ///< indices of the free joints, 1 to 3
  std::vector<double> lower, upper;  ///< one per free joint; not used for continuous joints
  JointVectord added_inertia;        ///< n
  std::vector<bool> locked;          ///< n, or empty
  bool has_hand_point = false;
  Vector3d hand_point = Vector3d::Zero();  ///< of the hand, in B, m
  std::vector<ObjectiveTerm> objective;
  std::vector<ImpulseCase> impulses;
  /// Boxes that hold every posture to be looked at; empty: all within the limits.
  std::vector<JointBox> places;
};

struct MinimumOptions {
  double relative_gap = 1e-3;  ///< of the best known value: good enough
  /// Boxes looked at, about 20 to 100 us each. A count, so that the answer is the same on every
  /// machine.
  long max_boxes = 20000;
  StopCondition stop = {};  ///< the bound that was reached counts
};

struct BoundedMinimum {
  double lower_bound = 0;        ///< of |y|, rounded down
  bool nothing_as_good = false;  ///< no posture reaches the best known value: it is wrong
  bool limit_reached = false;    ///< of boxes or by the stop condition
  long boxes = 0;
};

/// @param best value of the best posture known, > 0: nothing above it is looked at
/// @pre at most max_minimum_joints() joints, one to three of them free
BoundedMinimum bound_minimum(const MinimumProblem& problem, double best,
                             const MinimumOptions& options = {});
int max_minimum_joints();

/// What a bound says, in words and numbers.
struct MinimumBound {
  std::string statement;   ///< what was proven, or what was not, without "proven: "
  double lower_bound = 0;  ///< of the problem's measure, in its unit; zero: nothing was found out
  double gap = 0;          ///< best candidate's measure minus the lower bound
  long boxes = 0;          ///< looked at
};

/// Why the minimum of a capture problem cannot be bounded; empty: it can.
std::string minimum_objection(const CaptureProblem& problem);

/// The bound that belongs to a capture problem, in words and numbers.
/// @param impulses the predicted one; over a cone directions of it, the more the better
/// @param enclosed the problem's own proof: where all postures are enclosed, only they are looked
/// at
/// @param best the least value of the problem's measure among its candidates
/// @pre minimum_objection() is empty
MinimumBound prove_minimum(const CaptureProblem& problem, const std::vector<ImpulseCase>& impulses,
                           const Proof& enclosed, double best, const MinimumOptions& options = {});

}  // namespace stillbase
