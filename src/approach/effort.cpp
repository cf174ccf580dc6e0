#include "approach/effort.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/dynamics/base_acceleration.hpp>
#include <stillbase/dynamics/momentum.hpp>

namespace stillbase {

JointVectord joint_torques(const CaptureProblem& problem, const JointMotion& motion) {
  const RobotModel& robot = problem.robot;
  const auto kinematics = compute_kinematics<double>(robot, motion.phi);
  const auto inertia = compute_inertia<double>(robot, kinematics);
  Vector6d Omega = Vector6d::Zero(), dot_Omega = Vector6d::Zero();
  if (problem.approach.base != BaseMode::Held) {
    Omega = free_floating_base_velocity<double>(inertia, motion.phidot);
  }
  const auto bias = compute_bias<double>(robot, kinematics, inertia, Omega, motion.phidot);
  const auto jacobian = compute_hand_jacobian<double>(robot, kinematics);
  const BaseEquation equation{inertia, bias, jacobian};
  if (problem.approach.base != BaseMode::Held) {
    dot_Omega = base_acceleration(equation, {}, motion.phiddot);
  }
  JointVectord torques = joint_torque(equation, {}, dot_Omega, motion.phiddot);
  if (problem.resistance.model == ResistanceModel::RotorInertia) {
    torques += problem.resistance.rotor_inertia.cwiseProduct(motion.phiddot);
  }
  return torques;
}

double effort_used(const CaptureProblem& problem, const JointPath& path,
                   const EffortOptions& options) {
  const int count = options.checks_per_segment;
  double used = 0;
  for (std::size_t i = 0; i < path.segments(); ++i) {
    for (int check = 0; check <= count; ++check) {
      const double t = path.times[i] + (path.times[i + 1] - path.times[i]) * check / count;
      const JointVectord torques = joint_torques(problem, motion_on_segment(path, i, t));
      for (int k = 0; k < problem.robot.n(); ++k) {
        const double limit = problem.robot.joints[static_cast<std::size_t>(k)].max_effort;
        used = std::max(used, std::abs(torques[k]) / limit);
      }
    }
  }
  return used;
}

void slow_for_effort(const CaptureProblem& problem, JointPath& path, const EffortOptions& options) {
  EffortOptions coarse = options;
  coarse.checks_per_segment = 2;
  if (effort_used(problem, path, coarse) < options.surely_usable * options.usable) return;
  const double used = effort_used(problem, path, options);
  if (used > options.usable) stretch(path, std::sqrt(used / options.usable));
}

}  // namespace stillbase
