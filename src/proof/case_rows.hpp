// The equations of a case problem, divided by nothing, for any number type.
//
// With A = Htilde_phi + added inertia over the joints that move, h = Htilde_omegaphi, L the
// momentum impulse about the system centroid (16), s = tau - H_vphi' f / m, all per unit of
// impulse, the jump (6) reads
//   [Htilde_omega h; h' A] [Delta omega; Delta phidot] = [L; s].
// A is positive definite, so
//   total zero       L = 0
//   base part zero   L_i - h_i A^-1 s = 0            <=>  det [A s; h_i L_i] = 0
//   coupling zero    h_i A^-1 (s - h' w) = 0, w = Htilde_omega^-1 L
//                                                    <=>  det [A r; h_i 0] = 0,
//                    r = det(Htilde_omega) s - h' adj(Htilde_omega) L; r = s where L = 0 is asked
//                    for
// Determinants by expansion: a quotient of intervals is wider than both its parts.
//
// Of the hand's axes, the approach axis a has to lie along -n: its two components normal to n
// vanish, and it does not point along n (an inequality, side_conditions.hpp). All axes R have to be
// the wanted ones D: e = 1/2 sum r_i x d_i = sin(angle) axis vanishes, and the turn between them is
// none of 180 deg (inequalities as well). These equations are the planner's rows.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>

#include "dynamics/inertia_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "impact/jump_kernel.hpp"
#include "proof/hand_rows.hpp"
#include "proof/zero_problem.hpp"

namespace stillbase::proof {

/// Largest number of joints that move during the impact: determinants of one more row.
inline constexpr int kMaxMovingJoints = 3;

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

/// Rows whose determinants grow with the joints that move.
inline bool needs_few_moving_joints(const Row& row) {
  return row.kind == RowKind::Base || row.kind == RowKind::CouplingAtZeroTotal ||
         row.kind == RowKind::Coupling;
}

/// Determinant of the leading m x m block by expansion along the first column, m <= 4.
template <class S>
S determinant(const std::array<std::array<S, 4>, 4>& M, int m) {
  if (m == 0) return S(1.0);
  if (m == 1) return M[0][0];
  if (m == 2) return M[0][0] * M[1][1] - M[1][0] * M[0][1];
  S sum(0.0);
  for (int i = 0; i < m; ++i) {
    std::array<std::array<S, 4>, 4> minor;
    for (int r = 0, to = 0; r < m; ++r) {
      if (r == i) continue;
      for (int c = 1; c < m; ++c) minor[to][c - 1] = M[r][c];
      ++to;
    }
    const S term = M[i][0] * determinant(minor, m - 1);
    if (i % 2 == 0) {
      sum += term;
    } else {
      sum -= term;
    }
  }
  return sum;
}

/// Values of the rows where the variables are x.
template <class S>
std::vector<S> evaluate_rows(const ZeroProblem& problem, const std::vector<Row>& rows,
                             std::span<const S> x) {
  const RobotModel& robot = problem.robot;
  const EncounterModel& encounter = problem.encounter;
  const EncounterRange<S> at = encounter_over<S>(encounter, x);
  const Kinematics<S> kin = compute_kinematics<S>(robot, at.phi);
  const InertiaMatrices<S> inertia = compute_inertia<S>(robot, kin);
  const HandJacobian<S> jacobian = compute_hand_jacobian<S>(robot, kin);
  const TildeInertia<S> tilde = compute_tilde_inertia<S>(inertia);
  const Vector6<S>& F = at.F;
  const Vector3<S> f = F.template head<3>();
  const Vector3<S> L = momentum_change<S>(inertia, jacobian, F);

  std::vector<int> moving;
  for (int k = 0; k < robot.n(); ++k) {
    const auto index = static_cast<std::size_t>(k);
    if (index >= problem.locked.size() || !problem.locked[index]) moving.push_back(k);
  }
  const int m = static_cast<int>(moving.size());
  const bool has_determinants = std::any_of(rows.begin(), rows.end(), needs_few_moving_joints);
  assert(m <= kMaxMovingJoints || !has_determinants);
  std::array<std::array<S, 4>, 4> M;
  std::array<S, 4> s;
  for (int a = 0; has_determinants && a < m; ++a) {
    const int k = moving[a];
    for (int b = 0; b < m; ++b) M[a][b] = tilde.Htilde_phi(k, moving[b]);
    M[a][a] += S(problem.added_inertia[k]);
    const Vector3<S> p = inertia.H_bphi.template block<3, 1>(0, k);
    s[a] = jacobian.J_phi.col(k).dot(F) - p.dot(f) / inertia.mass;
  }
  /// det [A r; h_i corner].
  const auto bordered = [&](const std::array<S, 4>& r, int i, const S& corner) {
    for (int a = 0; a < m; ++a) {
      M[a][m] = r[a];
      M[m][a] = tilde.Htilde_omegaphi(i, moving[a]);
    }
    M[m][m] = corner;
    return determinant(M, m + 1);
  };
  const auto coupling = [&](int i) {
    const Matrix3<S>& Ho = tilde.Htilde_omega;
    const Vector3<S> a = Ho.col(0), b = Ho.col(1), c = Ho.col(2);
    const Vector3<S> bc = b.cross(c), ca = c.cross(a), ab = a.cross(b);
    const S det = a.dot(bc);
    const Vector3<S> w(bc.dot(L), ca.dot(L), ab.dot(L));  // adj(Ho) L
    std::array<S, 4> r;
    for (int k = 0; k < m; ++k) {
      const Vector3<S> h = tilde.Htilde_omegaphi.col(moving[k]);
      r[k] = det * s[k] - h.dot(w);
    }
    return bordered(r, i, S(0.0));
  };

  std::vector<S> out;
  for (const Row& row : rows) {
    S value(0.0);
    switch (row.kind) {
      case RowKind::HandPosition:
        value = kin.r_bh[row.index] - at.hand_point[row.index];
        break;
      case RowKind::HandAxis:
        value = axis_along<S>(encounter, at, kin.R_hand, row.direction);
        break;
      case RowKind::HandPose:
        value = axes_error<S>(encounter, at, kin.R_hand, row.index);
        break;
      case RowKind::Total: {
        const Vector3<S> direction = row.direction.cast<S>();
        value = encounter.is_fixed() ? direction.dot(L) : Vector3<S>(at.R_BE * direction).dot(L);
        break;
      }
      case RowKind::Base:
        value = bordered(s, row.index, L[row.index]);
        break;
      case RowKind::CouplingAtZeroTotal:
        value = bordered(s, row.index, S(0.0));
        break;
      case RowKind::Coupling:
        value = coupling(row.index);
        break;
    }
    out.push_back(value * S(1 / row.scale));
  }
  return out;
}

}  // namespace stillbase::proof
