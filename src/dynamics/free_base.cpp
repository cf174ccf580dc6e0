#include "dynamics/free_base.hpp"

#include <stillbase/dynamics/base_acceleration.hpp>
#include <stillbase/dynamics/momentum.hpp>

#include "dynamics/wide_joint_values.hpp"

namespace stillbase {

Vector6d free_base_velocity(const RobotModel& robot, const JointVectord& phi,
                            const JointVectord& phidot) {
  const WideKernel* const wide = wide_kernel(robot);
  if (wide == nullptr) {
    const auto kinematics = compute_kinematics<double>(robot, phi);
    return free_floating_base_velocity<double>(compute_inertia<double>(robot, kinematics), phidot);
  }
  Vector6d Omega;
  wide->base_velocity(robot, WideJointValues(robot, phi).plain(), phidot.data(), Omega.data());
  return Omega;
}

JointVectord motion_torques(const RobotModel& robot, const JointVectord& phi,
                            const JointVectord& phidot, const JointVectord& phiddot,
                            bool base_moves) {
  if (const WideKernel* const wide = wide_kernel(robot); wide != nullptr) {
    JointVectord torques(robot.n());
    wide->torques(robot, WideJointValues(robot, phi).plain(), {phidot.data(), phiddot.data()},
                  base_moves, torques.data());
    return torques;
  }
  const auto kinematics = compute_kinematics<double>(robot, phi);
  const auto inertia = compute_inertia<double>(robot, kinematics);
  Vector6d Omega = Vector6d::Zero(), dot_Omega = Vector6d::Zero();
  if (base_moves) Omega = free_floating_base_velocity<double>(inertia, phidot);
  const auto bias = compute_bias<double>(robot, kinematics, inertia, Omega, phidot);
  const auto jacobian = compute_hand_jacobian<double>(robot, kinematics);
  const BaseEquation equation{inertia, bias, jacobian};
  if (base_moves) dot_Omega = base_acceleration(equation, {}, phiddot);
  return joint_torque(equation, {}, dot_Omega, phiddot);
}

}  // namespace stillbase
