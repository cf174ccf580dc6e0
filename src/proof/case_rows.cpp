#include "proof/case_rows.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/dynamics/inertia.hpp>

#include "proof/elimination.hpp"
#include "proof/taylor.hpp"

namespace stillbase::proof {
namespace {

/// Rows that ask for the joints' part of the jump.
bool needs_joint_part(const Row& row) {
  return row.kind == RowKind::Base || row.kind == RowKind::CouplingAtZeroTotal ||
         row.kind == RowKind::Coupling;
}

/// h_i A^-1 r over the joints that move.
template <class S>
class JointPart {
 public:
  JointPart(const ZeroProblem& problem, const TildeInertia<S>& tilde) : tilde_(tilde) {
    for (int k = 0; k < problem.robot.n(); ++k) {
      const auto index = static_cast<std::size_t>(k);
      if (index >= problem.locked.size() || !problem.locked[index]) moving_.push_back(k);
    }
    elimination_ = Solver(static_cast<int>(moving_.size()), [&](int i, int j) {
      S value = tilde_.Htilde_phi(moving_[i], moving_[j]);
      if (i == j) value += S(problem.added_inertia[moving_[i]]);
      return value;
    });
  }

  /// @param r n entries, of which those of the joints that move count
  S row_times(int i, const JointVector<S>& r) const {
    Column h{}, right{};
    for (std::size_t a = 0; a < moving_.size(); ++a) {
      h[a] = tilde_.Htilde_omegaphi(i, moving_[a]);
      right[a] = r[moving_[a]];
    }
    return elimination_.product(elimination_.forward(h), elimination_.forward(right));
  }

 private:
  using Solver = Elimination<S, kMaxJointsOf<S>>;
  using Column = typename Solver::Column;

  const TildeInertia<S>& tilde_;
  std::vector<int> moving_;
  Solver elimination_;
};

}  // namespace

template <class S>
std::vector<S> evaluate_rows(const ZeroProblem& problem, const std::vector<Row>& rows,
                             std::span<const S> x) {
  const RobotModel& robot = problem.robot;
  const VariableEncounter& encounter = problem.encounter;
  const EncounterRange<S> at = encounter_over<S>(encounter, x);
  const Kinematics<S> kin = compute_kinematics<S>(robot, at.phi);
  const InertiaMatrices<S> inertia = compute_inertia<S>(robot, kin);
  const HandJacobian<S> jacobian = compute_hand_jacobian<S>(robot, kin);
  const TildeInertia<S> tilde = compute_tilde_inertia<S>(inertia);
  const Vector6<S>& F = at.F;
  const Vector3<S> f = F.template head<3>();
  const Vector3<S> r_gh = jacobian.r_bh() - inertia.r_bg;
  const Vector3<S> L = r_gh.cross(f) + F.template tail<3>();  // (16)

  std::optional<JointPart<S>> joint_part;
  JointVector<S> torque(robot.n());  // s
  if (std::any_of(rows.begin(), rows.end(), needs_joint_part)) {
    joint_part.emplace(problem, tilde);
    for (int k = 0; k < robot.n(); ++k) {
      const Vector3<S> p = inertia.H_bphi.template block<3, 1>(0, k);
      torque[k] = jacobian.J_phi.col(k).dot(F) - p.dot(f) / inertia.mass;
    }
  }
  /// det(Htilde_omega) (s - h' w).
  const auto torque_beside_total = [&] {
    const Matrix3<S>& Ho = tilde.Htilde_omega;
    const Vector3<S> a = Ho.col(0), b = Ho.col(1), c = Ho.col(2);
    const Vector3<S> bc = b.cross(c), ca = c.cross(a), ab = a.cross(b);
    const S det = a.dot(bc);
    const Vector3<S> w(bc.dot(L), ca.dot(L), ab.dot(L));  // adj(Ho) L
    JointVector<S> r(robot.n());
    for (int k = 0; k < robot.n(); ++k) {
      const Vector3<S> h = tilde.Htilde_omegaphi.col(k);
      r[k] = det * torque[k] - h.dot(w);
    }
    return r;
  };

  std::vector<S> out;
  for (const Row& row : rows) {
    S value(0.0);
    switch (row.kind) {
      case RowKind::Total: {
        const Vector3<S> direction = row.direction.cast<S>();
        value = encounter.is_fixed() ? direction.dot(L) : Vector3<S>(at.R_BE() * direction).dot(L);
        break;
      }
      case RowKind::Base:
        value = L[row.index] - joint_part->row_times(row.index, torque);
        break;
      case RowKind::CouplingAtZeroTotal:
        value = joint_part->row_times(row.index, torque);
        break;
      case RowKind::Coupling:
        value = joint_part->row_times(row.index, torque_beside_total());
        break;
      default:
        value = kinematic_value<S>(row, encounter, at, kin.r_bh, kin.R_hand);
    }
    out.push_back(value * S(1 / row.scale));
  }
  return out;
}

std::vector<double> row_tolerances(const ZeroProblem& problem, const std::vector<Row>& rows,
                                   std::span<const Dual> domain) {
  const EquationTolerances known;
  const VariableEncounter& encounter = problem.encounter;
  const double kinematic =
      known.feasible + (encounter.has(VariableKind::Time) ? known.integrated : 0);
  double part = kinematic, det = 1;
  if (std::any_of(rows.begin(), rows.end(), needs_joint_part)) {
    const EncounterRange<Dual> at = encounter_over<Dual>(encounter, domain);
    const Kinematics<Dual> kin = compute_kinematics<Dual>(problem.robot, at.phi);
    const TildeInertia<Dual> tilde =
        compute_tilde_inertia<Dual>(compute_inertia<Dual>(problem.robot, kin));
    Interval trace(0.0);
    for (int i = 0; i < 3; ++i) trace += tilde.Htilde_omega(i, i).v;
    const double largest = trace.upper();
    const double least = principal_moments(problem.robot.base.inertia)[0];
    part = kinematic * std::sqrt(largest / least);
    det = std::pow(largest / 3, 3);
  }
  std::vector<double> out;
  for (const Row& row : rows) {
    double tolerance = kinematic;
    if (needs_joint_part(row)) tolerance = part;
    // Where the total is zero but for the tolerance, it joins the coupling part.
    if (row.kind == RowKind::CouplingAtZeroTotal) tolerance = 2 * part;
    if (row.kind == RowKind::Coupling) tolerance = part * det;
    out.push_back(tolerance / row.scale);
  }
  return out;
}

Kept keeps_inequalities(const ZeroProblem& problem, std::span<const Dual> x, double slack) {
  if (problem.inequalities.empty()) return Kept::Yes;
  const EncounterRange<Dual> at = encounter_over<Dual>(problem.encounter, x);
  const Kinematics<Dual> kin = compute_kinematics<Dual>(problem.robot, at.phi);
  Kept all = Kept::Yes;
  for (const Row& row : problem.inequalities) {
    const Interval value =
        kinematic_value<Dual>(row, problem.encounter, at, kin.r_bh, kin.R_hand).v;
    if (value.upper() < row.lower - slack || value.lower() > row.upper + slack) return Kept::No;
    if (!(value.lower() >= row.lower && value.upper() <= row.upper)) all = Kept::Open;
  }
  return all;
}

template std::vector<Dual> evaluate_rows(const ZeroProblem&, const std::vector<Row>&,
                                         std::span<const Dual>);
template std::vector<Quadratic<2>> evaluate_rows(const ZeroProblem&, const std::vector<Row>&,
                                                 std::span<const Quadratic<2>>);
template std::vector<Quadratic<3>> evaluate_rows(const ZeroProblem&, const std::vector<Row>&,
                                                 std::span<const Quadratic<3>>);

}  // namespace stillbase::proof
