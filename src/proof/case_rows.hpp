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
// vanish, and it does not point along n (an inequality). All axes R have to be
// the wanted ones D: e = 1/2 sum r_i x d_i = sin(angle) axis vanishes, and the rotation between
// them is none of 180 deg (inequalities as well). These equations are the planner's rows.
#pragma once

#include <span>

#include "proof/zero_problem.hpp"

namespace stillbase::proof {

/// Value of a row of hand and base.
/// @param r_bh, R_hand hand from the base centroid and its axes, in B
template <class S>
S kinematic_value(const Row& row, const VariableEncounter& encounter, const EncounterRange<S>& at,
                  const Vector3<S>& r_bh, const Matrix3<S>& R_hand) {
  const int i = row.index;
  switch (row.kind) {
    case RowKind::HandPosition:
      return r_bh[i] - at.hand_point[i];
    case RowKind::HandAxis: {
      const Vector3<S> a = R_hand * Vector3<S>(encounter.approach_axis.cast<S>());
      return Vector3<S>(at.R_BE() * Vector3<S>(row.direction.cast<S>())).dot(a);
    }
    case RowKind::HandPose: {
      const Matrix3<S> wanted = wanted_hand_axes<S>(encounter, at.R_NB, at.contact.R_EB);
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      S value(0.0);
      for (int c = 0; c < 3; ++c) {
        value += R_hand(j, c) * wanted(k, c) - R_hand(k, c) * wanted(j, c);
      }
      return value;
    }
    case RowKind::HandAxisAlong:
      return Vector3<S>(wanted_hand_axes<S>(encounter, at.R_NB, at.contact.R_EB).col(i))
          .dot(Vector3<S>(R_hand.col(i)));
    case RowKind::ClosingSpeed:
      return at.closing_speed;
    case RowKind::BasePosition: {
      const Vector3<S> r = at.R_NB * r_bh;
      return at.contact_point[i] - r[i];
    }
    case RowKind::Parameters:
      return at.parameters_squared;
    case RowKind::BaseTilt: {
      const Vector3d& axis = encounter.tilt_axis;
      const Vector3d in_B = encounter.R_NB.transpose() * axis;
      const Vector3<S> tilted = at.R_NB * Vector3<S>(in_B.cast<S>());
      return tilted.dot(Vector3<S>(axis.cast<S>()));
    }
    default:
      return S(0.0);  // rows of the jump: evaluate_rows()
  }
}

/// Values of rows where the variables are x, over their scales: Dual or Quadratic.
template <class S>
std::vector<S> evaluate_rows(const ZeroProblem& problem, const std::vector<Row>& rows,
                             std::span<const S> x);

/// By how much the value of each row, over its scale, may miss zero where the planner takes a
/// configuration for a solution. The planner's rows of the jump are the momenta themselves. Ours
/// are (Htilde_omega - G) Htilde_omega^-1 times them, G = h A^-1 h' between zero and Htilde_omega:
/// a factor of at most the root of Htilde_omega's condition number, and its eigenvalues lie between
/// the least one of the base's own inertia and the trace.
/// @param domain all values of the variables
std::vector<double> row_tolerances(const ZeroProblem& problem, const std::vector<Row>& rows,
                                   std::span<const Dual> domain);

enum class Kept { Yes, No, Open };

/// Whether the inequalities hold at every point of a box (Yes), at none by more than `slack` (No).
/// @param x values of the variables over the box
Kept keeps_inequalities(const ZeroProblem& problem, std::span<const Dual> x, double slack = 0);

}  // namespace stillbase::proof
