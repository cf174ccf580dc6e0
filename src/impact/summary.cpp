#include <stillbase/impact/summary.hpp>

#include <stdexcept>

#include <stillbase/impact/attach_target.hpp>
#include <stillbase/impact/contact_response.hpp>
#include <stillbase/impact/gradient.hpp>

namespace stillbase {

namespace {

/// All but the total angular momentum and the case; base and coupling part are those of the jump.
/// @param tilde of the body that moves after the impact
ImpactSummary summarize_jump(const TildeInertia<double>& tilde, const ImpactJump<double>& jump,
                             const Vector6d& Fbar, double closing_speed,
                             const JointResistance& resistance) {
  const ReactionNullSpace space = angular_reaction_null_space(tilde);
  const JointVelocityParts parts = decompose_joint_velocity(space, jump.Delta_phidot);
  ImpactSummary out;
  out.Fbar = Fbar;
  out.Delta_Omega = jump.Delta_Omega;
  out.Delta_phidot = jump.Delta_phidot;
  out.Delta_phidot_rns = parts.rns;
  out.Delta_phidot_orthogonal = parts.orthogonal;
  out.base = tilde.Htilde_omega * jump.Delta_Omega.tail<3>();
  out.coupling = tilde.Htilde_omegaphi * jump.Delta_phidot;
  out.rank_tolerance = space.rank_tolerance;
  out.rank = space.rank;
  out.closing_speed = closing_speed;
  out.resistance = resistance;
  return out;
}

double momentum_scale(const PostureImpact<double>& posture, const Vector6d& Fbar) {
  const double lever = case_lever(posture.kinematics.r_bh, posture.inertia.r_bg);
  return Fbar.head<3>().norm() * lever + Fbar.tail<3>().norm();
}

/// Robot and held target as one, the axes of the target's frame parallel to B.
RobotModel held_robot(const RobotModel& robot, const Kinematics<double>& kinematics,
                      const TargetAtHand<double>& target) {
  TargetBody body;
  body.mass = 1 / target.inverse_mass;
  body.inertia = target.inertia;
  const Pose hand{kinematics.r_bh, Eigen::Quaterniond(kinematics.R_hand)};
  const Pose target_pose{kinematics.r_bh - target.r, Eigen::Quaterniond::Identity()};
  return attach_target(robot, hand, body, target_pose);
}

}  // namespace

ImpactSummary summarize_impact(const RobotModel& robot, const JointVectord& phi,
                               const JointResistance& resistance, const Vector6d& Fbar,
                               double closing_speed, double case_tolerance) {
  const auto posture = evaluate_posture(robot, prepare_resistance(resistance, robot.n()), phi);
  const auto jump = compute_jump(posture.factor, posture.jacobian, Fbar);
  ImpactSummary out = summarize_jump(posture.tilde, jump, Fbar, closing_speed, resistance);
  out.total = momentum_change(posture.inertia, posture.jacobian, Fbar);
  out.judgement =
      judge_case(out.total, out.base, out.coupling, momentum_scale(posture, Fbar), case_tolerance);
  return out;
}

namespace {

/// The velocities before a contact with a hand that moves, beside those of a hand at rest.
MotionBefore motion_before(const PostureImpact<double>& posture,
                           const RigidContact<double>& contact) {
  RigidContact<double> at_rest = contact;
  at_rest.matched = MatchedPart::None;
  const auto other = respond_to_contact(posture, at_rest);
  const HandMotion<double>& hand = contact.before;
  MotionBefore out;
  out.Omega = hand.Omega;
  out.phidot = hand.phidot;
  out.hand_velocity = hand.V;
  out.relative_velocity = contact.target.velocity_at_hand() - hand.V;
  out.base = posture.tilde.Htilde_omega * hand.Omega.tail<3>();
  const bool pulls = contact.law == ContactLaw::Sticking && other.F.head<3>().dot(contact.n) < 0;
  if (pulls) return out;
  out.Fbar_at_rest = other.F;
  out.base_at_rest = other.base;
  return out;
}

}  // namespace

ImpactSummary summarize_contact(const RobotModel& robot, const JointVectord& phi,
                                const JointResistance& resistance,
                                const RigidContact<double>& stated, double closing_speed,
                                double case_tolerance) {
  const ImpactResistance prepared = prepare_resistance(resistance, robot.n());
  const auto posture = evaluate_posture(robot, prepared, phi);
  RigidContact<double> contact = stated;
  const auto response = respond_to_contact(posture, contact);
  const bool moves = contact.matched != MatchedPart::None;
  ImpactJump<double> jump = response.d;
  if (moves) {
    jump.Delta_Omega -= contact.before.Omega;
    jump.Delta_phidot -= contact.before.phidot;
  }
  // Momenta right after the contact, in place of those of the jump alone.
  const auto add_motion = [&](const TildeInertia<double>& tilde, ImpactSummary& out) {
    if (!moves) return;
    out.before = motion_before(posture, contact);
    out.base = tilde.Htilde_omega * out.Omega_after().tail<3>();
    out.coupling = tilde.Htilde_omegaphi * out.phidot_after();
  };
  if (contact.law != ContactLaw::Latch) {
    ImpactSummary out =
        summarize_impact(robot, phi, resistance, response.F, closing_speed, case_tolerance);
    if (!moves) return out;
    add_motion(posture.tilde, out);
    out.judgement = judge_case(out.total, out.base, out.coupling,
                               momentum_scale(posture, response.F), case_tolerance);
    return out;
  }
  if (robot.hand_body == kBase) {
    throw std::invalid_argument("a latch needs a hand that moves relative to the base");
  }
  const TargetAtHand<double>& target = contact.target;
  const RobotModel whole = held_robot(robot, posture.kinematics, target);
  const auto after = evaluate_posture(whole, prepared, phi);
  ImpactSummary out = summarize_jump(after.tilde, jump, response.F, closing_speed, resistance);
  add_motion(after.tilde, out);
  out.total = response.total;
  const double reduced_mass =
      posture.inertia.mass / (1 + posture.inertia.mass * target.inverse_mass);
  const Vector3d s = posture.kinematics.r_bh - target.r - posture.inertia.r_bg;
  const double scale =
      (target.inertia * target.omega).norm() + reduced_mass * s.norm() * target.velocity.norm();
  out.judgement = judge_case(out.total, out.base, out.coupling, scale, case_tolerance);
  return out;
}

}  // namespace stillbase
