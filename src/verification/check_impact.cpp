// Does the impact happen as stated? Impulse by the contact law, jump and momenta by (6).
#include <algorithm>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/tolerances.hpp"

namespace stillbase::verification {
namespace {

/// Tolerances that the format of plans fixes: a plan that states others is not comparable.
constexpr double kCaseToleranceOfPlans = 1e-6;
constexpr double kRankToleranceOfPlans = 1e-10;

/// Tolerances of what a plan states of its impact.
struct ImpactCheckOptions {
  double fixed = 1e-12;  ///< relative, of a tolerance that the format fixes: it is copied
  /// Relative: joint rates that match a velocity have the condition of the Jacobian.
  double arrival = 1e-9;
};
constexpr ImpactCheckOptions kImpact;

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
      name, std::abs(stated / fixed - 1), kImpact.fixed, "1",
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

/// The robot right before a contact with a hand that moves.
void check_motion_before(const Context& context, ClaimList& claims) {
  const std::optional<MotionOfRobot>& found = context.situation.response.before;
  const std::optional<MotionBefore>& stated = context.plan.impact.before;
  if (!found && !stated) return;
  Objections objections;
  objections.demand(found.has_value(), "the problem's hand waits, the plan's moves");
  objections.demand(stated.has_value(), "the problem's hand moves, the plan's waits");
  claims.none_wrong("hand_motion", objections, "motion of the hand as the problem states it");
  if (!objections.none()) return;
  const Situation& situation = context.situation;
  const auto same = [&](const char* name, const Eigen::VectorXd& said, const Eigen::VectorXd& own,
                        double scale, const char* what) {
    claims.same(name, relative_error(said, own, scale), kImpact.arrival,
                fmt::format("{:.6g} {}", own.norm(), what));
  };
  Vector6d apart;
  apart << *situation.event.velocity, situation.event.omega;
  const Vector3d speeds = apart.head<3>();
  const double size = speeds.norm() + situation.event.omega.norm();
  apart -= found->hand;
  same("arrival_joint_rates", stated->phidot, found->phidot, 0, "rad/s before the contact");
  same("arrival_base_velocity", stated->Omega, found->Omega, found->phidot.norm(),
       "m/s and rad/s without momentum");
  same("arrival_hand_velocity", stated->hand_velocity, found->hand, size, "m/s and rad/s");
  claims.at_most("arrival_relative_velocity",
                 (stated->relative_velocity - apart).cwiseAbs().maxCoeff(),
                 kShared.matched_velocity, "m/s or rad/s",
                 fmt::format("stated velocity of the target less that of the hand, {:.3g} m/s and "
                             "{:.3g} rad/s, from the recomputed one",
                             apart.head<3>().norm(), apart.tail<3>().norm()));
  const DecidedVelocity decided = decided_velocity(context.problem, situation.event, situation.at);
  claims.at_most("arrival_match",
                 std::max(decided.error(found->hand), decided.error(stated->hand_velocity)),
                 kShared.matched_velocity, "m/s or rad/s",
                 fmt::format("velocity of the hand, stated and recomputed, from the {} components "
                             "that the problem decides",
                             decided.values.size()));
  Largest rate;
  for (int k = 0; k < context.problem.robot.n(); ++k) {
    rate.take(std::abs(found->phidot[k]) / arrival_rate_limit(context.problem, k),
              context.problem.robot.joints[k].name);
  }
  claims.at_most("arrival_rate_limits", rate.value, 1 + context.options.limit_slack, "1",
                 "largest fraction of a rate limit before the contact: " + rate.place);

  // What a hand at rest would meet in the same posture.
  CaptureProblem waiting = context.problem;
  waiting.hand_motion = {};
  const Situation at_rest(waiting, situation.at);
  const Vector6d Fbar = at_rest.impulse();
  same("at_rest_impulse", stated->Fbar_at_rest, Fbar, situation.response.rounding_scale(Fbar),
       "N s and N m s on a hand at rest");
  same("at_rest_base_momentum", stated->base_at_rest, at_rest.response.impact(Fbar).base,
       situation.response.rounding_scale(Fbar), "N m s with a hand at rest");
  const Matrix3d robot = posture_dynamics(waiting, situation.at.phi).dynamics.Htilde_omega;
  const Vector3d base = robot * found->Omega.tail<3>();
  same("arrival_base_momentum", stated->base, base, robot.trace() * found->phidot.norm(),
       "N m s of the base before the contact");
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
  // A matched hand leaves rounding of what the target would bring to a hand at rest.
  const double brought =
      response.before ? context.problem.target->mass * situation.event.velocity->norm() : 0;
  same("impulse_force", stated.Fbar.head<3>(), f, brought, "N s by the contact law");
  same("impulse_moment", stated.Fbar.tail<3>(), t, rounding, "N m s");
  if (context.problem.impulse.contact == ContactLaw::Sticking) {
    claims.at_least("contact_pushes", situation.event.n.dot(f), 0, 0, "N s",
                    "force of the sticking contact along the normal: none that pulls");
  }

  const reference::Impact impact = response.impact(Fbar), jump = response.jump(Fbar);
  const double rate_scale = 3 * rounding / response.dynamics.Htilde_omega.trace();
  same("base_linear_velocity_jump", stated.Delta_Omega.head<3>(), jump.Delta_Omega.head<3>(),
       std::max(f.norm(), brought) / response.dynamics.mass, "m/s");
  same("base_angular_velocity_jump", stated.Delta_Omega.tail<3>(), jump.Delta_Omega.tail<3>(),
       rate_scale, "rad/s");
  same("joint_velocity_jump", stated.Delta_phidot, jump.Delta_phidot, rate_scale, "rad/s");
  check_null_space(context, jump.Delta_phidot, rate_scale, claims);
  same("total_angular_momentum", stated.total, impact.total, rounding, "N m s");
  same("base_angular_momentum", stated.base, impact.base, rounding, "N m s");
  same("coupling_angular_momentum", stated.coupling, impact.coupling, rounding, "N m s");
  check_case(context, Fbar, claims);
  check_motion_before(context, claims);
}

}  // namespace stillbase::verification
