// Where the hand of a robot touches a target in a first problem, and the posture to start from.
#pragma once

#include <optional>

#include <stillbase/collision/scene.hpp>
#include <stillbase/plan/problem.hpp>

namespace stillbase::app {

/// Clearance of a first problem, m: that of its constraints and its approach.
inline constexpr double kDraftClearance = 0.01;

/// Where the robot starts, and how the target lies at the contact.
struct DraftEncounter {
  JointVectord start;
  Vector3d axis = Vector3d::UnitZ();       ///< of the hand's frame, out of the hand
  Pose target;                             ///< at the contact, in B
  Vector3d direction = Vector3d::UnitX();  ///< in which the hand points then, in B
  double standoff = 0;                     ///< the hand's frame was moved so far along `axis`, m
  bool is_further = false;                 ///< than where the shapes of the hand's body end
  decltype(SceneParts::allowed_contacts) allowed_contacts;
  double contact_share = 1;  ///< these touch in this part of all postures, at the least
  double connected = 1;      ///< part of the free postures between which the arm can move, about
};

/// Why no posture was found: how far the search came in all its attempts.
struct DraftObstruction {
  bool links_are_free = false;   ///< in some posture no links touch
  bool points_outwards = false;  ///< in some of these by kOutwards at least
};

/// Least cosine between the hand's axis and the direction from the base to the hand.
inline constexpr double kOutwards = 0.3;
inline constexpr double kAnyDirection = -1;

/// Samples postures for one that is free of collision, points away from the base and lets the arm
/// move; from the start the hand moves forwards to it along a line that is free.
///
/// Links that are always closer than the clearance are allowed to touch. Where no posture is free,
/// the hand's frame moves out to where the shapes of its body end and further, then links that
/// touch in nearly all postures are allowed to. The same where free postures are not connected: a
/// search would find contacts to which no path leads. In the end links of the arm with one
/// body between theirs may touch that do so in a third of all postures: shapes that are too large,
/// not the arm.
/// @param robot its hand's frame is moved by `standoff` where something is found
/// @param may_move_hand the problem can state where the hand's frame is
/// @param outwards kOutwards or kAnyDirection
/// @param obstruction is added to
/// @return nothing: no posture is free
std::optional<DraftEncounter> find_encounter(RobotModel& robot, const TargetBody& target,
                                             bool may_move_hand, double outwards,
                                             DraftObstruction& obstruction);

/// How far shapes of the base's body, without those of `link`, reach from a point along a unit
/// vector of B, m; 0: they do not.
double reach_of_base(const RobotModel& robot, const std::string& link, const Vector3d& from,
                     const Vector3d& along);

}  // namespace stillbase::app
