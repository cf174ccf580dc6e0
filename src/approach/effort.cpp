#include "approach/effort.hpp"

#include <algorithm>
#include <cmath>

#include "dynamics/free_base.hpp"

namespace stillbase {

JointVectord joint_torques(const CaptureProblem& problem, const JointMotion& motion) {
  JointVectord torques = motion_torques(problem.robot, motion.phi, motion.phidot, motion.phiddot,
                                        problem.approach.base != BaseMode::Held);
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
