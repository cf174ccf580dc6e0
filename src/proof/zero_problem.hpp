// The equations of one problem, and the inequalities that its solutions keep.
#pragma once

#include <optional>
#include <vector>

#include <stillbase/proof/proof.hpp>

#include "proof/encounter_kernel.hpp"

namespace stillbase::proof {

/// Inequalities that every solution keeps.
enum class SideKind {
  HandFacing,    ///< approach axis along n
  PoseFacing,    ///< axis `index` of the hand along the wanted one
  ClosingSpeed,  ///< m/s
  BasePosition,  ///< component of the position that puts the hand on its point, m
  TurnSize,      ///< |sigma|^2 of the base's rotation
  BaseTilt       ///< cosine of the angle by which an axis of the base is tilted
};

struct SideCondition {
  SideKind kind;
  int index = 0;
  double lower = 0, upper = 0;
};

/// Equations and inequalities over the encounter's variables.
struct ZeroProblem {
  RobotModel robot;
  VariableEncounter encounter;
  JointVectord added_inertia;  ///< n
  std::vector<bool> locked;    ///< n, or empty
  CaseConstraint impact_case = CaseConstraint::None;
  std::optional<ObjectiveQuantity> zero;  ///< also this vanishes
  bool has_hand_point = false;            ///< the hand is at its point
  bool has_hand_axis = false;             ///< the approach axis lies along n
  bool has_hand_axes = false;             ///< all axes are the wanted ones
  std::vector<SideCondition> side_conditions;
  bool has_limits = false;  ///< on rates, singular values or clearances: solutions are judged
};

/// The variables, equations and inequalities of a capture problem. Constraints on rates, singular
/// values and clearances are left out.
ZeroProblem zero_problem(const CaptureProblem& problem);

/// Every zero of the equations that keeps the side conditions within the bounds of the variables.
/// @return status Complete: every solution is in exactly one of the boxes `solutions`, each of
/// which holds exactly one; Undecided: every solution is in one of them or in one of `undecided`;
/// NotApplicable: the equations are not as many as the variables
/// @pre the base attitude is fixed or free about one axis: other rotations have two parameter
/// vectors on the surface of the ball
Proof enclose_solutions(const ZeroProblem& problem, const ProofOptions& options = {});

}  // namespace stillbase::proof
