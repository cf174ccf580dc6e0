// How the base moves along a joint path: not at all, or as momentum conservation demands.
#pragma once

#include <vector>

#include <stillbase/plan/plan.hpp>

#include "approach/joint_path.hpp"

namespace stillbase {

/// Omega = -H_b^-1 H_bphi phidot, in B.
Vector6d base_velocity(const RobotModel& robot, const JointMotion& motion);

/// Displacement of the base over [t0, t1] within segment i: T(t1) = T(t0) * displacement.
/// One step of the fourth-order Magnus method: the base twist depends on time alone.
Pose base_step(const RobotModel& robot, const JointPath& path, std::size_t i, double t0, double t1);

/// The same over as many steps as keep the estimated error below `tolerance` (m and rad), by
/// halving.
Pose base_displacement(const RobotModel& robot, const JointPath& path, std::size_t i,
                       double tolerance);

/// Base poses T_NB at all samples of the path so that the last one is `end`.
std::vector<Pose> base_poses(const RobotModel& robot, const JointPath& path, BaseMode mode,
                             const Pose& end);

/// The same of a floating base that starts at `begin`.
std::vector<Pose> base_poses_from(const RobotModel& robot, const JointPath& path,
                                  const Pose& begin);

/// System centroid in B, m.
Vector3d system_centroid(const RobotModel& robot, const Kinematics<double>& kinematics);

/// Bound on how far the system centroid moves in B per unit of each joint (n).
JointVectord centroid_levers(const RobotModel& robot);

}  // namespace stillbase
