// What the joints must give along a motion.
#pragma once

#include <stillbase/plan/plan.hpp>

#include "approach/joint_path.hpp"

namespace stillbase {

/// Joint torques (n, N m or N) of (3) without external wrenches. The base floats without momentum,
/// or is held; rotor inertias of the problem turn with their joints, friction is left out.
JointVectord joint_torques(const CaptureProblem& problem, const JointMotion& motion);

/// Largest part of a joint's effort limit that a path needs, looked at eight times per segment.
double effort_used(const CaptureProblem& problem, const JointPath& path);

/// Slows the whole path down until it keeps the effort limits. Torques of a motion from rest to
/// rest go with the inverse square of its duration: there are no forces but those of inertia.
void slow_for_effort(const CaptureProblem& problem, JointPath& path);

}  // namespace stillbase
