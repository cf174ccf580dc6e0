// One attempt at an approach: waypoints, time law, base motion, collision check over time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "approach/motion_check.hpp"
#include "approach/task.hpp"

namespace stillbase {

/// How one attempt differs from the next.
struct AttemptOptions {
  std::uint64_t seed = 1;
  double resolution = 0.02;
  int max_iterations = 0;     ///< of the planner
  double wait = 0;            ///< s
  std::vector<Pose> targets;  ///< T_NT to avoid; those that start or goal touch are left out
};

struct AttemptResult {
  ApproachStatus status = ApproachStatus::GoalUnreachable;
  std::string detail;
  std::size_t way_points = 0;
  double motion_start = 0, motion_end = 0;  ///< s, when a path was timed
  double shortfall = 0;                     ///< TooSlow: s
  bool hit_by_target = false;
  bool hopeless = false;  ///< the target hits a body that no path moves
  TimedMotion motion;
  std::optional<TargetMotion> target;  ///< its motion to where the hand ends
  Configuration end;                   ///< configuration at the end; set when there is a motion
  bool has_end = false;
  double before_polish = 0, after_polish = 0;  ///< s or rad
};

/// From a joint path at rest to rest (times from 0 on) to a motion that arrives `wait` before the
/// contact: closed where the base starts as stated, slowed to the torque limits, with base motion,
/// limits and collisions checked. Sets everything of `result` but way_points and the polish.
void finish_motion(const ApproachTask& task, JointPath path, double wait, AttemptResult& result);

/// One of the goals of an attempt.
struct AttemptGoal {
  const ApproachTask* task = nullptr;
  AttemptOptions options;
  double weight = 1;  ///< how often it is sampled, relative to the others
};

/// Path, time law, base motion, checks and polish, to the goal that the planner reaches first.
/// @param goals at least one, of the same problem; random numbers follow from the first one's seed
/// @param reached index in `goals` of the goal that the result is about
AttemptResult try_approach(const std::vector<AttemptGoal>& goals, const StopCondition& stop,
                           std::size_t& reached);

}  // namespace stillbase
