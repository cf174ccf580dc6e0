#include <stillbase/simulation/latch.hpp>

namespace stillbase {

LatchedRobot latch_target(const RobotModel& robot, const JointResistance& resistance,
                          const PlantState& before, const TargetBody& target,
                          const TargetPlantState& target_before, const Vector3d& normal_N) {
  const Kinematics<double> kinematics = compute_kinematics(robot, before.phi);
  const Eigen::Quaterniond R_BN = before.base.orientation.conjugate();
  const Pose hand_N = before.base * Pose{kinematics.r_bh, Eigen::Quaterniond(kinematics.R_hand)};
  const Eigen::Quaterniond R_BT = R_BN * target_before.pose.orientation;

  ContactTarget body;  // in B
  body.mass = target.mass;
  body.inertia = R_BT.toRotationMatrix() * target.inertia * R_BT.toRotationMatrix().transpose();
  body.r = R_BN * Vector3d(hand_N.position - target_before.pose.position);
  body.velocity = R_BN * target_before.velocity;
  body.angular_velocity = R_BT * target_before.angular_velocity;
  Contact contact;
  contact.law = ContactLaw::Latch;
  contact.n = R_BN * normal_N;
  const ContactOutcome outcome =
      apply_contact(robot, before.phi, before.Omega, before.phidot, resistance, contact, body);

  const Pose hand_target = hand_N.inverse() * target_before.pose;
  LatchedRobot latched{robot, before, hand_target, outcome.impulse};
  if (outcome.impulse.status != ContactStatus::Hit) return latched;
  latched.robot = attach_target(robot, target, hand_target);
  latched.state.Omega = outcome.after.Omega;
  latched.state.phidot = outcome.after.phidot;
  const Vector3d shift = base_shift(robot, target, hand_target);
  latched.state.base.position += before.base.orientation * shift;
  latched.state.Omega.head<3>() += Vector3d(outcome.after.Omega.tail<3>()).cross(shift);
  return latched;
}

}  // namespace stillbase
