#include <stillbase/impact/summary.hpp>

#include <stillbase/impact/gradient.hpp>

namespace stillbase {

ImpactSummary summarize_impact(const RobotModel& robot, const JointVectord& phi,
                               const JointResistance& resistance, const Vector6d& Fbar,
                               double closing_speed, double case_tolerance) {
  const auto posture = evaluate_posture(robot, prepare_resistance(resistance, robot.n()), phi);
  const auto jump = compute_jump(posture.factor, posture.jacobian, Fbar);
  const ReactionNullSpace space = angular_reaction_null_space(posture.tilde);
  const JointVelocityParts parts = decompose_joint_velocity(space, jump.Delta_phidot);

  ImpactSummary out;
  out.Fbar = Fbar;
  out.Delta_Omega = jump.Delta_Omega;
  out.Delta_phidot = jump.Delta_phidot;
  out.Delta_phidot_rns = parts.rns;
  out.Delta_phidot_orthogonal = parts.orthogonal;
  out.total = momentum_change(posture.inertia, posture.jacobian, Fbar);
  out.base = posture.tilde.Htilde_omega * jump.Delta_Omega.tail<3>();
  out.coupling = posture.tilde.Htilde_omegaphi * jump.Delta_phidot;
  const double lever = case_lever(posture.kinematics.r_bh, posture.inertia.r_bg);
  const double scale = Fbar.head<3>().norm() * lever + Fbar.tail<3>().norm();
  out.judgement = judge_case(out.total, out.base, out.coupling, scale, case_tolerance);
  out.rank_tolerance = space.rank_tolerance;
  out.rank = space.rank;
  out.closing_speed = closing_speed;
  out.resistance = resistance;
  return out;
}

}  // namespace stillbase
