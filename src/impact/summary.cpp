#include <stillbase/impact/summary.hpp>

#include "impact/case_lever.hpp"

namespace stillbase {

ImpactSummary summarize_impact(const RobotModel& robot, const JointVectord& phi,
                               const JointResistance& resistance, const Vector6d& Fbar,
                               double closing_speed, double case_tolerance) {
  const auto kinematics = compute_kinematics<double>(robot, phi);
  const auto inertia = compute_inertia(robot, kinematics);
  const auto tilde = compute_tilde_inertia(inertia);
  const auto jacobian = compute_hand_jacobian(robot, kinematics);
  const auto factor = factorize_impact(
      inertia, added_impact_inertia(resistance, robot.n()),
      resistance.model == ResistanceModel::Locked ? resistance.locked : std::vector<bool>{});
  const auto jump = compute_jump(factor, jacobian, Fbar);
  const ReactionNullSpace space = angular_reaction_null_space(tilde);
  const JointVelocityParts parts = decompose_joint_velocity(space, jump.Delta_phidot);

  ImpactSummary out;
  out.Fbar = Fbar;
  out.Delta_Omega = jump.Delta_Omega;
  out.Delta_phidot = jump.Delta_phidot;
  out.Delta_phidot_rns = parts.rns;
  out.Delta_phidot_orthogonal = parts.orthogonal;
  out.total = momentum_change(inertia, jacobian, Fbar);
  out.base = tilde.Htilde_omega * jump.Delta_Omega.tail<3>();
  out.coupling = tilde.Htilde_omegaphi * jump.Delta_phidot;
  const double scale =
      Fbar.head<3>().norm() * case_lever(kinematics.r_bh, inertia.r_bg) + Fbar.tail<3>().norm();
  out.judgement = judge_case(out.total, out.base, out.coupling, scale, case_tolerance);
  out.rank_tolerance = space.rank_tolerance;
  out.rank = space.rank;
  out.closing_speed = closing_speed;
  out.resistance = resistance;
  return out;
}

}  // namespace stillbase
