// The equations of one problem, and the inequalities that its solutions keep.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <stillbase/proof/proof.hpp>

#include "proof/variable_encounter.hpp"

namespace stillbase::proof {

/// Scalar functions of the variables. case_rows.hpp derives those of the jump.
enum class RowKind {
  // Of hand and base, see kinematic_value().
  HandPosition,   ///< component `index` of the hand's distance from its point, in B, m
  HandAxis,       ///< component of the approach axis along `direction`, in E
  HandPose,       ///< component `index` of the rotation error sum r_i x d_i of the hand's axes
  HandAxisAlong,  ///< cosine between axis `index` of the hand and the wanted one
  ClosingSpeed,   ///< m/s
  BasePosition,   ///< component `index` of the position that puts the hand on its point, in N, m
  Parameters,     ///< |sigma|^2 of the base's rotation
  BaseTilt,       ///< cosine of the angle by which an axis of the base is tilted
  // Of the jump.
  Total,  ///< momentum along `direction`: in B while the encounter is fixed, else in E
  Base,   ///< row `index` of the base part
  CouplingAtZeroTotal,  ///< row `index` of the coupling part where the total is zero
  Coupling              ///< row `index` of the coupling part
};

/// An equation, value = 0, or an inequality, lower <= value <= upper.
struct Row {
  RowKind kind;
  int index = 0;
  Vector3d direction = Vector3d::Zero();
  double lower = 0, upper = 0;
  double scale = 1;  ///< typical size of an equation, a power of two by which it is divided
};

/// How exactly the planner's configurations are known.
struct EquationTolerances {
  /// By which configurations may violate their constraints: twice what the planner allows, since
  /// its rows are components along other axes, m, rad, s, m/s.
  double feasible = 2e-9;
  /// By which the contact point of the planner's integrated target may be off, m: four times what
  /// tests/proof/spin_test.cpp finds.
  double integrated = 4e-9;
};

/// Equations and inequalities over the encounter's variables.
struct ZeroProblem {
  RobotModel robot;  ///< without drives
  VariableEncounter encounter;
  JointVectord added_inertia;  ///< n; of resistance and drives
  std::vector<bool> locked;    ///< n, or empty
  CaseConstraint impact_case = CaseConstraint::None;
  std::optional<ResponsePart> zero;  ///< also this momentum vanishes
  std::vector<Row> hand_equations;
  std::vector<Row> inequalities;
  /// Limits of the problem that are not among the inequalities, as statements name them: solutions
  /// are judged by them.
  std::vector<std::string> uncounted_limits;
};

/// The variables, equations and inequalities of a capture problem. Constraints on rates, singular
/// values and clearances are named in place of being counted.
ZeroProblem zero_problem(const CaptureProblem& problem);

/// All equations, those that may vanish identically included.
std::vector<Row> all_rows(const ZeroProblem& problem);

}  // namespace stillbase::proof
