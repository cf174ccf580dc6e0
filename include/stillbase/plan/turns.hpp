// Angles of a joint that are whole turns apart: one posture, several ways to hold it.
//
// A revolute joint whose limits are at least 2 pi apart reaches every angle, some of them more than
// once. q and q + 2 pi are the same posture with the same impact; they differ in the distance from
// the limits alone.
#pragma once

#include <optional>
#include <vector>

#include <stillbase/plan/plan.hpp>

namespace stillbase {

/// Whether other bodies' joints follow this one, or its own body moves otherwise than by its angle.
bool takes_part_in_coupling(const RobotModel& robot, int joint);

/// Whether a joint is continuous and whole turns of it are one posture: no other joint follows it.
bool is_endless(const RobotModel& robot, int joint);

/// Whether whole turns of a joint are one posture: it is revolute, free, and its limits less
/// `joint_limit_margin` are at least 2 pi apart. Not where angles count as such: with functions of
/// the user, a simulated objective (joints reach their stops) or a joint that others follow. Not of
/// continuous joints, which have no limits and are wrapped everywhere.
bool has_whole_turns(const CaptureProblem& problem, int joint);

/// The angle nearest to the middle of the joint's limits, of those whole turns apart.
/// @pre has_whole_turns()
double central_angle(const Joint& joint, double angle);

/// The whole turns that there is room for from a configuration.
/// @param rolled joint that may have any angle anyway, see free_joint()
std::vector<JointTurns> whole_turns(const CaptureProblem& problem,
                                    const Configuration& configuration, std::optional<int> rolled);

/// Whether the joints of a are nearer to the start posture as they are, without whole turns more or
/// less: by the root of the sum of squares; as near, but with smaller angles.
bool is_nearer_to_start(const CaptureProblem& problem, const Configuration& a,
                        const Configuration& b);

/// What the joints turn from the start posture, rad (m): endless ones the shorter way, those with
/// whole turns to the nearest of these within their limits (n).
JointVectord way_from_start(const CaptureProblem& problem, const Configuration& configuration);

/// The norm of that.
double least_way_from_start(const CaptureProblem& problem, const Configuration& configuration);

/// The other configurations that are whole turns away, the nearest to the start posture first.
/// @param most at most so many of them
std::vector<Configuration> other_turns(const CaptureProblem& problem,
                                       const Configuration& configuration,
                                       std::optional<int> rolled, std::size_t most);

}  // namespace stillbase
