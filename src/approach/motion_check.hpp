// Clearance of straight lines for the planner, and of the timed motion as stored against the moving
// target.
#pragma once

#include <optional>
#include <vector>

#include "approach/task.hpp"

namespace stillbase {

/// The scene of the planner, without time. The base is where it is at the end (held), or keeps the
/// final attitude while the system centroid stays (floating). The attitude change along the path is
/// known only afterwards and checked then.
class StillScene {
 public:
  /// @param targets poses T_NT that must all be avoided
  StillScene(const ApproachTask& task, std::vector<Pose> targets, double resolution);
  std::optional<Proximity> first_hit(const JointVectord& phi) const;
  /// On the straight line between two postures, parts `begin` to `end` of it: proven clear, or
  /// checked at the resolution.
  bool is_motion_clear(const JointVectord& a, const JointVectord& b, double begin = 0,
                       double end = 1) const {
    return is_part_clear(a, b, begin, end, nullptr);
  }

 private:
  /// Pairs that a longer part of a line left unsure.
  struct Unsure {
    std::vector<std::size_t> alone, beside_target;  ///< of scene_, of target_scene_
  };
  /// @param before null: every pair
  bool is_part_clear(const JointVectord& a, const JointVectord& b, double begin, double end,
                     const Unsure* before) const;
  Pose base_at(const Kinematics<double>& kinematics) const;

  const CaptureProblem& problem_;
  CollisionScene scene_, target_scene_;
  Pose goal_base_;
  Vector3d centroid_;  ///< of the system in N
  JointVectord centroid_levers_;
  std::vector<Pose> targets_;
  double resolution_;
};

struct TimedHit {
  Proximity proximity;
  double time = 0;
};

/// The motion as stored, base included, followed by the wait.
struct TimedMotion {
  JointPath path;                ///< from the start to the arrival
  std::vector<Pose> base_poses;  ///< T_NB at the samples of path
  double contact_time = 0;
};

/// Nothing but the wait at a configuration.
TimedMotion waiting_motion(const Configuration& at, double wait);

/// First hit along the motion and the wait: every interval is proven clear or split until nothing
/// in it moves further than MotionCheckOptions::finest says.
/// @param target null: not there. @throws std::out_of_range beyond the horizon of the prediction
std::optional<TimedHit> first_hit(const ApproachTask& task, const TimedMotion& motion,
                                  const TargetMotion* target);

/// Smallest distance along the motion and the wait, sampled at half the resolution.
Proximity smallest_clearance(const ApproachTask& task, const TimedMotion& motion,
                             const TargetMotion* target);

}  // namespace stillbase
