// Does the impact happen as stated? Impulse by the contact law, jump and momenta by (6).
#include <fmt/format.h>

#include "verification/checks.hpp"

namespace stillbase::verification {
namespace {

// The tolerance of a case may be tightened by a plan, never widened.
// The tolerances of a plan are those that its format names; another one is another statement.
constexpr double kCaseToleranceOfPlans = 1e-6;
constexpr double kRankToleranceOfPlans = 1e-10;

struct Residuals {
  double total, base, coupling;
};

ImpactCase judge(const Residuals& residuals, double tolerance) {
  if (residuals.total <= tolerance) {
    return residuals.base <= tolerance && residuals.coupling <= tolerance ? ImpactCase::C2
                                                                          : ImpactCase::C1;
  }
  if (residuals.base <= tolerance) return ImpactCase::G2;
  if (residuals.coupling <= tolerance) return ImpactCase::G3;
  return ImpactCase::G1;
}

const char* name_of(ImpactCase impact_case) {
  switch (impact_case) {
    case ImpactCase::G1:
      return "G1";
    case ImpactCase::G2:
      return "G2";
    case ImpactCase::G3:
      return "G3";
    case ImpactCase::C1:
      return "C1";
    case ImpactCase::C2:
      return "C2";
  }
  return "?";
}

bool same_resistance(const JointResistance& a, const JointResistance& b) {
  auto same = [](const JointVectord& x, const JointVectord& y) {
    return x.size() == y.size() && x == y;
  };
  if (a.model != b.model) return false;
  switch (a.model) {
    case ResistanceModel::Free:
      return true;
    case ResistanceModel::RotorInertia:
      return same(a.rotor_inertia, b.rotor_inertia);
    case ResistanceModel::Servo:
      return same(a.stiffness, b.stiffness) && same(a.damping, b.damping) &&
             a.contact_duration == b.contact_duration;
    case ResistanceModel::Locked:
      return a.locked == b.locked;
  }
  return false;
}

// The case that the problem demands, as the residuals that must vanish.
void check_case_constraint(CaseConstraint wanted, const Residuals& residuals, double tolerance,
                           ClaimList& claims) {
  double residual = 0;
  std::string what;
  switch (wanted) {
    case CaseConstraint::None:
      return;
    case CaseConstraint::C:
    case CaseConstraint::C1:
      residual = residuals.total;
      what = "total momentum";
      break;
    case CaseConstraint::C2:
      residual = std::max({residuals.total, residuals.base, residuals.coupling});
      what = "total momentum, base part and coupling part";
      break;
    case CaseConstraint::G2:
      residual = residuals.base;
      what = "base part";
      break;
    case CaseConstraint::G3:
      residual = residuals.coupling;
      what = "coupling part";
      break;
  }
  claims.at_most("case_constraint", residual, tolerance, "1",
                 what + " left by the impact, relative to |f| |r_gh| + |t|");
}

}  // namespace

void check_impact(const Context& context, const ContactEvent& event,
                  const PostureResponse& response, ClaimList& claims) {
  const ImpactSummary& stated = context.plan.impact;
  const double tolerance = context.options.recompute_tolerance;

  claims.none_wrong("joint_resistance",
                    same_resistance(stated.resistance, context.problem.resistance)
                        ? std::vector<std::string>{}
                        : std::vector<std::string>{"differs"},
                    "resistance of the joints as in the problem");

  const Vector6d Fbar = impulse_along(context.problem, event, response, event.n);
  const Vector3d f = Fbar.head<3>(), t = Fbar.tail<3>();
  claims.same("impulse_force", relative_error(stated.Fbar.head<3>(), f), tolerance,
              fmt::format("contact law gives {:.6g} N s", f.norm()));
  claims.same("impulse_moment",
              relative_error(stated.Fbar.tail<3>(), t, response.rounding_scale(Fbar)), tolerance,
              fmt::format("{:.6g} N m s", t.norm()));

  const reference::Impact impact = response.impact(Fbar);
  const double scale = response.momentum_scale(Fbar), rounding = response.rounding_scale(Fbar);
  const double rate_scale = 3 * rounding / response.dynamics.Htilde_omega.trace();
  const Vector3d v = impact.Delta_Omega.head<3>(), omega = impact.Delta_Omega.tail<3>();
  claims.same("base_linear_velocity_jump",
              relative_error(stated.Delta_Omega.head<3>(), v, f.norm() / response.dynamics.mass),
              tolerance, fmt::format("{:.6g} m/s", v.norm()));
  claims.same("base_angular_velocity_jump",
              relative_error(stated.Delta_Omega.tail<3>(), omega, rate_scale), tolerance,
              fmt::format("{:.6g} rad/s", omega.norm()));
  claims.same("joint_velocity_jump",
              relative_error(stated.Delta_phidot, impact.Delta_phidot, rate_scale), tolerance,
              fmt::format("{:.6g} rad/s", impact.Delta_phidot.norm()));

  const double rank_tolerance = stated.rank_tolerance;
  claims.at_most(
      "rank_tolerance", std::abs(rank_tolerance / kRankToleranceOfPlans - 1), 1e-12, "1",
      fmt::format("singular values below {:.3g} of the largest count as zero: the stated "
                  "tolerance from that",
                  kRankToleranceOfPlans));
  const NullSpace space = null_space(response.dynamics.Htilde_omegaphi, rank_tolerance);
  const Eigen::VectorXd rns = space.projector * impact.Delta_phidot;
  const double joint_scale = std::max(rate_scale, impact.Delta_phidot.norm());
  claims.at_most("coupling_rank", std::abs(stated.rank - space.rank), 0, "1",
                 fmt::format("rank of the angular coupling matrix: stated {}, found {}",
                             stated.rank, space.rank));
  claims.same("joint_velocity_rns", relative_error(stated.Delta_phidot_rns, rns, joint_scale),
              tolerance, "part in the reaction null space");
  claims.same(
      "joint_velocity_orthogonal",
      relative_error(stated.Delta_phidot_orthogonal, impact.Delta_phidot - rns, joint_scale),
      tolerance, "part orthogonal to it");

  auto momentum = [&](const char* name, const Vector3d& said, const Vector3d& found) {
    claims.same(name, relative_error(said, found, rounding), tolerance,
                fmt::format("{:.6g} N m s", found.norm()));
  };
  momentum("total_angular_momentum", stated.total, impact.total);
  momentum("base_angular_momentum", stated.base, impact.base);
  momentum("coupling_angular_momentum", stated.coupling, impact.coupling);

  const double divisor = scale > 0 ? scale : 1;
  const Residuals residuals{impact.total.norm() / divisor, impact.base.norm() / divisor,
                            impact.coupling.norm() / divisor};
  const CaseJudgement& judgement = stated.judgement;
  claims.at_most(
      "case_tolerance", std::abs(judgement.tolerance / kCaseToleranceOfPlans - 1), 1e-12, "1",
      fmt::format("a relative momentum below {:.3g} counts as zero: the stated tolerance "
                  "from that",
                  kCaseToleranceOfPlans));
  const ImpactCase found = judge(residuals, judgement.tolerance);
  claims.at_most(
      "impact_case", judgement.impact_case == found ? 0 : 1, 0, "1",
      fmt::format("stated {}, found {}", name_of(judgement.impact_case), name_of(found)));
  claims.same("case_residuals",
              relative_error(Vector3d(judgement.total, judgement.base, judgement.coupling),
                             Vector3d(residuals.total, residuals.base, residuals.coupling),
                             std::max(1.0, rounding / divisor)),
              tolerance, "momenta relative to |f| |r_gh| + |t|");
  check_case_constraint(context.problem.constraints.impact_case, residuals, judgement.tolerance,
                        claims);
}

}  // namespace stillbase::verification
