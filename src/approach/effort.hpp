// Joint torques along a motion.
#pragma once

#include <stillbase/approach/options.hpp>
#include <stillbase/plan/plan.hpp>

#include "approach/joint_path.hpp"

namespace stillbase {

/// Joint torques (n, N m or N) of (3) without external wrenches. The base floats without momentum,
/// or is held; rotor inertias of the problem turn with their joints, friction is left out.
JointVectord joint_torques(const CaptureProblem& problem, const JointMotion& motion);

/// Largest torque along a path over the joint's limit.
double effort_used(const CaptureProblem& problem, const JointPath& path,
                   const EffortOptions& options = {});

/// Slows the whole path down until it keeps the torque limits. Torques of a motion from rest to
/// rest scale with the inverse square of its duration, as there are only inertial forces.
void slow_for_effort(const CaptureProblem& problem, JointPath& path,
                     const EffortOptions& options = {});

}  // namespace stillbase
