// How the target meets a robot that waits with its hand at the point of impact.
#pragma once

#include <optional>

#include <stillbase/plan/problem.hpp>

namespace stillbase {

/// Motion of the target in N around the contact.
///
/// With an impulse direction that follows from the contact feature this is the predicted motion of
/// the stated estimate. With a stated direction n the encounter is built backwards: the target
/// comes along n at the stated closing speed without turning, and touches the hand at the contact
/// time: with its contact feature if one is named (turned so that its normal is n), else with the
/// surface of its sphere (centre at hand - radius n), else with its centroid.
/// @param hand_N hand position in N at the contact, m
/// @param R_NB attitude of the base at the contact
/// @return nothing when the problem has no target body
std::optional<TargetMotion> encounter_motion(const CaptureProblem& problem, const Vector3d& hand_N,
                                             const Eigen::Quaterniond& R_NB, double contact_time);

/// The contact feature that the problem names.
/// @pre the problem has a target with that feature (the reader has checked it)
const ContactFeature& chosen_feature(const CaptureProblem& problem);

/// The problem with this feature met; as it is for an empty name.
CaptureProblem at_feature(CaptureProblem problem, const std::string& feature);

}  // namespace stillbase
