// A proof that no posture was missed: every solution of a small case problem, enclosed.
//
// Branch and bound with interval arithmetic whose ends are rounded outwards. What is proven is
// proven of the model: the numbers of the robot and of the problem as the doubles that the planner
// uses. Equations that vanish identically but for rounding (the out-of-plane ones of a planar
// robot) are left out; leaving an equation out can only add solutions.
//
// Assumptions: base attitude, base position and contact time fixed, at most three free joints, at
// most three joints that move during the impact. Everything else is "not applicable", with the
// reason.
#pragma once

#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>

namespace stillbase {

struct ProofOptions {
  /// Boxes looked at before the rest is called undecided; about 20 to 100 us each. A count, so
  /// that the answer is the same on every machine.
  long max_boxes = 50000;
  double min_width = 1e-8;  ///< rad: below it a box is undecided
  StopCondition stop = {};  ///< what is left then is undecided
};

/// What the zeros are of: one robot, one wrench.
struct ZeroProblem {
  RobotModel robot;
  JointVectord start;                ///< n, positions of the joints that are not free
  std::vector<int> free;             ///< indices of the free joints, 1 to 3
  std::vector<double> lower, upper;  ///< one per free joint; not used for continuous joints
  JointVectord added_inertia;        ///< n
  std::vector<bool> locked;          ///< n, or empty
  Vector6d F = Vector6d::Zero();     ///< wrench on the hand per unit of impulse, in B
  CaseConstraint impact_case = CaseConstraint::None;
  std::optional<ObjectiveQuantity> zero;  ///< also this vanishes
  bool has_hand_point = false;
  Vector3d hand_point = Vector3d::Zero();  ///< of the hand, in B, m
};

/// Every zero of the equations within the joint limits.
/// @return status Complete: every solution is in exactly one of the boxes `solutions`, each of
/// which holds exactly one; Undecided: every solution is in one of them or in one of `undecided`;
/// NotApplicable: the equations are not as many as the free joints
Proof enclose_solutions(const ZeroProblem& problem, const ProofOptions& options = {});

/// The proof that belongs to a capture problem.
///
/// A case problem with as many equations as free joints: all its solutions. A problem whose
/// equations leave freedom that its objective's zeros take up: all postures at which the objective
/// vanishes, which are its global minima (lower bound zero). Where it vanishes nowhere, that alone
/// is said.
/// @param F wrench per unit of impulse in B at the contact (the problem's encounter)
Proof prove(const CaptureProblem& problem, const Vector6d& F, const ProofOptions& options = {});

}  // namespace stillbase
