// The nominal motion of the target towards a robot that waits with its hand at the contact point.
#pragma once

#include <optional>

#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// How long after the contact a hand that moved may take to stop, s.
inline constexpr double kLongestAbort = 60;

/// How long before and after its estimate a target is asked for whose motion decides the impulse,
/// s.
double motion_horizon(const CaptureProblem& problem);

/// Nominal motion of the target in N around the contact.
///
/// With an impulse direction that follows from the contact feature this is the torque-free motion
/// of the stated estimate. With a stated direction n the motion is built backwards: the target
/// moves along n at the stated closing speed without rotation, and touches the hand at the contact
/// time with its contact feature if one is named (its normal is n), else with the surface of its
/// sphere (centroid at hand - radius n), else with its centroid.
/// @param hand_N hand position in N at the contact, m
/// @param R_NB attitude of the base at the contact
/// @param contact_time s
/// @return nothing when the problem has no target body
std::optional<TargetMotion> encounter_motion(const CaptureProblem& problem, const Vector3d& hand_N,
                                             const Eigen::Quaterniond& R_NB, double contact_time);

/// The same towards the hand of a configuration.
std::optional<TargetMotion> encounter_motion(const CaptureProblem& problem,
                                             const Configuration& configuration);

/// State of the target at the contact time of a configuration. A named contact feature is at the
/// hand, also where the nominal motion would bring it elsewhere.
/// @return nothing when the problem has no target body
std::optional<TargetState> target_at_contact(const CaptureProblem& problem,
                                             const Configuration& configuration);
/// The same. @param motion encounter_motion() of that configuration
std::optional<TargetState> target_at_contact(const CaptureProblem& problem,
                                             const std::optional<TargetMotion>& motion,
                                             const Configuration& configuration);

}  // namespace stillbase
