// Checks that a path as stored has to pass, whether it leads to the contact or away from it.
#pragma once

#include <string>
#include <vector>

#include "verification/checks.hpp"
#include "verification/clearance.hpp"
#include "verification/path_motion.hpp"

namespace stillbase::verification {

/// Largest difference of two postures. @param modulo_full_rotations of continuous joints
double largest_difference(const RobotModel& robot, const JointVectord& a, const JointVectord& b,
                          bool modulo_full_rotations);

/// Joint, rate and acceleration limits along a path.
/// @param name of the path, before those of the checks
void check_path_limits(const Context& context, const Approach& path, const std::string& name,
                       ClaimList& claims);

/// Torques along a path against the torque limits, and their largest fraction as stated.
void check_torque_use(const Context& context, const Approach& path, double stated,
                      const std::string& name, ClaimList& claims);

/// The clearance of a path, and the smallest one as stated: that lies between what is proven and
/// the distances at the planner's instants.
/// @param included in words, what else is among the distances
void check_path_clearance(const Context& context, const PathClearance& found, double stated,
                          const std::string& name, const std::string& included, ClaimList& claims);

/// Torques by the second implementation of the dynamics: M [Omega'; phi''] + c = [0; tau], the base
/// floating without momentum or held; rotor inertias rotate with their joints.
Eigen::VectorXd path_torques(const CaptureProblem& problem, const Eigen::VectorXd& phi,
                             const Eigen::VectorXd& phidot, const Eigen::VectorXd& phiddot);

/// Motion of the base between the samples, from each stored pose on.
std::vector<BaseTrack> base_tracks(const CaptureProblem& problem, const Approach& path);

/// The path to rest after a contact that did not close: begins with the contact's state, ends at
/// rest away from the target, keeps every limit and touches nothing.
void check_abort(const Context& context, ClaimList& claims);

}  // namespace stillbase::verification
