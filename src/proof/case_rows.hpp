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
#pragma once

#include <stillbase/proof/proof.hpp>

#include <array>
#include <cassert>

#include "dynamics/inertia_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "impact/jump_kernel.hpp"
#include "proof/interval.hpp"

/// Dual numbers are wide: their matrices take the joints of the determinants and some locked ones.
template <int N>
inline constexpr int stillbase::kMaxJointsOf<stillbase::proof::Dual<N>> = 8;

namespace stillbase::proof {

/// Largest number of joints that move during the impact: determinants of one more row.
inline constexpr int kMaxMovingJoints = 3;

enum class RowKind { HandPosition, Total, Base, CouplingAtZeroTotal, Coupling };

/// One scalar equation: a component of the hand's distance from its point, along a direction of
/// the total momentum, or row `index` of base part or coupling part.
struct Row {
  RowKind kind;
  int index = 0;
  Vector3d direction = Vector3d::Zero();  ///< Total
  double scale = 1;  ///< typical size, a power of two by which the row is divided
};

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

/// Values of the rows at joint positions phi (n).
template <class S>
std::vector<S> evaluate_rows(const ZeroProblem& problem, const std::vector<Row>& rows,
                             const JointVector<S>& phi) {
  const RobotModel& robot = problem.robot;
  const Kinematics<S> kin = compute_kinematics<S>(robot, phi);
  const InertiaMatrices<S> inertia = compute_inertia<S>(robot, kin);
  const HandJacobian<S> jacobian = compute_hand_jacobian<S>(robot, kin);
  const TildeInertia<S> tilde = compute_tilde_inertia<S>(inertia);
  const Vector6<S> F = problem.F.cast<S>();
  const Vector3<S> f = F.template head<3>();
  const Vector3<S> L = momentum_change<S>(inertia, jacobian, F);

  std::vector<int> moving;
  for (int k = 0; k < robot.n(); ++k) {
    const auto index = static_cast<std::size_t>(k);
    if (index >= problem.locked.size() || !problem.locked[index]) moving.push_back(k);
  }
  const int m = static_cast<int>(moving.size());
  assert(m <= kMaxMovingJoints);
  std::array<std::array<S, 4>, 4> M;
  std::array<S, 4> s;
  for (int a = 0; a < m; ++a) {
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
        value = kin.r_bh[row.index] - S(problem.hand_point[row.index]);
        break;
      case RowKind::Total: {
        const Vector3<S> direction = row.direction.cast<S>();
        value = direction.dot(L);
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
