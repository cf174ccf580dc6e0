// The equations of a case problem, for dual intervals and Taylor models.
//
// With A = Htilde_phi + added inertia over the joints that move, h = Htilde_omegaphi, L the
// momentum impulse about the system centroid (16), s = tau - H_vphi' f / m, all per unit of
// impulse, the jump (6) reads
//   [Htilde_omega h; h' A] [Delta omega; Delta phidot] = [L; s].
// A is positive definite, so
//   total zero       L = 0
//   base part zero   L_i - h_i A^-1 s = 0
//   coupling zero    h_i A^-1 (s - h' w) = 0, w = Htilde_omega^-1 L; times det(Htilde_omega):
//                    h_i A^-1 r = 0, r = det(Htilde_omega) s - h' adj(Htilde_omega) L;
//                    r = s where L = 0 is an equation
// A^-1 by elimination (elimination.hpp): over a box that is too wide for it the rows are unbounded.
//
// Of the hand's axes, the approach axis a has to lie along -n: its two components normal to n
// vanish, and it does not point along n (an inequality, side_conditions.hpp). All axes R have to be
// the wanted ones D: e = 1/2 sum r_i x d_i = sin(angle) axis vanishes, and the rotation between
// them is none of 180 deg (inequalities as well). These equations are the planner's rows.
#pragma once

#include <span>

#include "proof/zero_problem.hpp"

namespace stillbase::proof {

enum class RowKind { HandPosition, HandAxis, HandPose, Total, Base, CouplingAtZeroTotal, Coupling };

/// One scalar equation: a component of the hand's distance from its point, of its approach axis
/// along a direction normal to n, of its rotation error, of the total momentum along a direction,
/// or row `index` of base part or coupling part.
struct Row {
  RowKind kind;
  int index = 0;
  /// HandAxis: in E. Total: in B while the encounter is fixed, else in E.
  Vector3d direction = Vector3d::Zero();
  double scale = 1;  ///< typical size, a power of two by which the row is divided
};

/// Values of the rows where the variables are x: Dual or Quadratic.
template <class S>
std::vector<S> evaluate_rows(const ZeroProblem& problem, const std::vector<Row>& rows,
                             std::span<const S> x);

}  // namespace stillbase::proof
