// Does the impact happen as stated? Impulse by the contact law, jump and momenta by (6).
#include <fmt/format.h>

#include "verification/checks.hpp"

namespace stillbase::verification {
namespace {

/// Tolerances that the format of plans fixes: a plan that states others is not comparable.
constexpr double kCaseToleranceOfPlans = 1e-6;
constexpr double kRankToleranceOfPlans = 1e-10;

const char* name_of(ImpactCase impact_case) {
  constexpr const char* kNames[] = {"G1", "G2", "G3", "C1", "C2"};
  return kNames[static_cast<std::size_t>(impact_case)];
}

ImpactCase judge(const CaseResiduals& residuals, double tolerance) {
  if (residuals.total <= tolerance) {
    return residuals.base <= tolerance && residuals.coupling <= tolerance ? ImpactCase::C2
                                                                          : ImpactCase::C1;
  }
  if (residuals.base <= tolerance) return ImpactCase::G2;
  if (residuals.coupling <= tolerance) return ImpactCase::G3;
  return ImpactCase::G1;
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

/// Stated tolerance against the one that the format of plans fixes.
void check_tolerance(const std::string& name, double stated, double fixed, const char* what,
                     ClaimList& claims) {
  claims.at_most(
      name, std::abs(stated / fixed - 1), 1e-12, "1",
      fmt::format("{} below {:.3g} counts as zero: the stated tolerance from that", what, fixed));
}

void check_case(const Context& context, const Vector6d& Fbar, ClaimList& claims) {
  const PostureResponse& response = context.situation.response;
  const CaseResiduals residuals = case_residuals(context.problem, response, Fbar);
  const CaseJudgement& stated = context.plan.impact.judgement;
  check_tolerance("case_tolerance", stated.tolerance, kCaseToleranceOfPlans, "a relative momentum",
                  claims);
  const ImpactCase found = judge(residuals, stated.tolerance);
  claims.at_most("impact_case", stated.impact_case == found ? 0 : 1, 0, "1",
                 fmt::format("stated {}, found {}", name_of(stated.impact_case), name_of(found)));
  const double scale = response.momentum_scale(Fbar);
  const std::string size = response.held ? "the momentum of the target" : "|f| |r_gh| + |t|";
  claims.same(
      "case_residuals",
      relative_error(Vector3d(stated.total, stated.base, stated.coupling),
                     Vector3d(residuals.total, residuals.base, residuals.coupling),
                     std::max(1.0, response.rounding_scale(Fbar) / (scale > 0 ? scale : 1))),
      context.options.recompute_tolerance, "momenta relative to " + size);
  const VanishingMomenta wanted = vanishing_momenta(context.problem.constraints.impact_case);
  if (wanted.momenta.empty()) return;
  claims.at_most("case_constraint", residuals.wanted, stated.tolerance, "1",
                 fmt::format("{} left by the impact, relative to {}", wanted.names, size));
}

/// Rank of the coupling matrix, and the joint velocity jump split by its null space.
void check_null_space(const Context& context, const Eigen::VectorXd& jump, double rate_scale,
                      ClaimList& claims) {
  const ImpactSummary& stated = context.plan.impact;
  const double tolerance = context.options.recompute_tolerance;
  check_tolerance("rank_tolerance", stated.rank_tolerance, kRankToleranceOfPlans,
                  "a singular value relative to the largest", claims);
  const NullSpace space =
      null_space(context.situation.response.dynamics.Htilde_omegaphi, stated.rank_tolerance);
  const Eigen::VectorXd rns = space.projector * jump;
  const double scale = std::max(rate_scale, jump.norm());
  claims.at_most("coupling_rank", std::abs(stated.rank - space.rank), 0, "1",
                 fmt::format("rank of the angular coupling matrix: stated {}, found {}",
                             stated.rank, space.rank));
  claims.same("joint_velocity_rns", relative_error(stated.Delta_phidot_rns, rns, scale), tolerance,
              "part in the reaction null space");
  claims.same("joint_velocity_orthogonal",
              relative_error(stated.Delta_phidot_orthogonal, jump - rns, scale), tolerance,
              "part orthogonal to it");
}

}  // namespace

void check_impact(const Context& context, ClaimList& claims) {
  const ImpactSummary& stated = context.plan.impact;
  const Situation& situation = context.situation;
  const PostureResponse& response = situation.response;
  const auto same = [&](const char* name, const Eigen::VectorXd& said, const Eigen::VectorXd& found,
                        double scale, const char* unit) {
    claims.same(name, relative_error(said, found, scale), context.options.recompute_tolerance,
                fmt::format("{:.6g} {}", found.norm(), unit));
  };

  const double v_n = closing_speed(context.problem, situation.event, situation.event.n);
  same("closing_speed", Eigen::VectorXd::Constant(1, stated.closing_speed),
       Eigen::VectorXd::Constant(1, v_n),
       situation.event.velocity ? situation.event.velocity->norm() : 0,
       "m/s along the direction of the impulse");
  Objections resistance;
  resistance.demand(same_resistance(stated.resistance, context.problem.resistance), "differs");
  claims.none_wrong("joint_resistance", resistance, "resistance of the joints as in the problem");

  const Vector6d Fbar = situation.impulse();
  const Vector3d f = Fbar.head<3>(), t = Fbar.tail<3>();
  const double rounding = response.rounding_scale(Fbar);
  same("impulse_force", stated.Fbar.head<3>(), f, 0, "N s by the contact law");
  same("impulse_moment", stated.Fbar.tail<3>(), t, rounding, "N m s");
  if (context.problem.impulse.contact == ContactLaw::Sticking) {
    claims.at_least("contact_pushes", situation.event.n.dot(f), 0, 0, "N s",
                    "force of the sticking contact along the normal: none that pulls");
  }

  const reference::Impact impact = response.impact(Fbar);
  const double rate_scale = 3 * rounding / response.dynamics.Htilde_omega.trace();
  same("base_linear_velocity_jump", stated.Delta_Omega.head<3>(), impact.Delta_Omega.head<3>(),
       f.norm() / response.dynamics.mass, "m/s");
  same("base_angular_velocity_jump", stated.Delta_Omega.tail<3>(), impact.Delta_Omega.tail<3>(),
       rate_scale, "rad/s");
  same("joint_velocity_jump", stated.Delta_phidot, impact.Delta_phidot, rate_scale, "rad/s");
  check_null_space(context, impact.Delta_phidot, rate_scale, claims);
  same("total_angular_momentum", stated.total, impact.total, rounding, "N m s");
  same("base_angular_momentum", stated.base, impact.base, rounding, "N m s");
  same("coupling_angular_momentum", stated.coupling, impact.coupling, rounding, "N m s");
  check_case(context, Fbar, claims);
}

}  // namespace stillbase::verification
