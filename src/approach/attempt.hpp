// One attempt at an approach: waypoints, time law, base motion, collision check over time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "approach/motion_check.hpp"

namespace stillbase {

/// A goal and how it is attempted.
struct AttemptGoal {
  explicit AttemptGoal(ApproachTask what);
  /// The target as a still obstacle where it will be at the arrival.
  void avoid_target_at_arrival();

  ApproachTask task;
  double resolution;          ///< rad
  int max_iterations;         ///< of the planner
  double wait;                ///< s
  std::vector<Pose> targets;  ///< T_NT to avoid; those that start or goal touch are left out
  double weight = 1;          ///< how often it is sampled, relative to the other goals
  std::size_t index = 0;      ///< among those asked for
  int failures = 0;           ///< of attempts that led to it
  int base_hits = 0;          ///< of these, those that no longer wait avoids
};

struct AttemptResult {
  ApproachStatus status = ApproachStatus::GoalUnreachable;
  std::string detail;
  std::size_t way_points = 0;
  double motion_start = 0, motion_end = 0;  ///< s, when a path was timed
  double shortfall = 0;                     ///< TooSlow: s
  bool hit_by_target = false;
  bool is_base_hit = false;  ///< the base, or what is fixed to it, with or without a longer wait
  bool hopeless = false;     ///< the base, which no path moves
  TimedMotion motion;
  std::optional<TargetMotion> target;          ///< its motion to where the hand ends
  std::optional<Configuration> end;            ///< configuration at the end, when there is a motion
  double before_polish = 0, after_polish = 0;  ///< s or rad

  const TargetMotion* target_or_null() const { return target ? &*target : nullptr; }
};

/// The target's motion to the hand at `end`.
std::optional<TargetMotion> target_for(const ApproachTask& task, const Configuration& end);

/// From a joint path at rest to rest (times from 0 on) to a motion that arrives `wait` before the
/// contact: closed where the base starts as stated, slowed to the torque limits, with base motion,
/// limits and collisions checked. Sets everything of `result` but way_points and the polish.
void finish_motion(const ApproachTask& task, JointPath path, double wait, AttemptResult& result);

/// Path, time law, base motion, checks and polish, to the goal that the planner reaches first.
/// @param goals at least one, of the same problem
/// @param reached index in `goals` of the goal that the result is about
AttemptResult try_approach(const std::vector<const AttemptGoal*>& goals, std::uint64_t seed,
                           const StopCondition& stop, std::size_t& reached);

}  // namespace stillbase
