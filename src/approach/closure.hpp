// A floating base with a stated start: its final pose follows from the path, and the path must end
// at a posture that solves the contact at that pose.
#pragma once

#include <stillbase/approach/approach.hpp>

#include "approach/joint_path.hpp"

namespace stillbase {

struct ClosedPath {
  JointPath path;                ///< its last posture is that of `end`
  std::vector<Pose> base_poses;  ///< T_NB at its samples, from problem.base
  Configuration end;             ///< solves the contact at the base pose in which the path ends
  double open = 0;               ///< m or rad between both base poses, when not closed
  bool closed = false;
};

/// Shifts the path until it ends at a posture that solves the contact at the base pose that it
/// ends with: first the best posture for each base pose in turn, then Newton's method on the pose.
/// @param path from rest to rest, at times from 0 on; its last posture solves the contact with the
///   base at `assumed`, from where the pose is led to the one that the path leaves
ClosedPath close_path(const CaptureProblem& problem, const JointPath& path, const Pose& assumed,
                      const ContactSolver& solve, const ClosureOptions& options = {});

}  // namespace stillbase
