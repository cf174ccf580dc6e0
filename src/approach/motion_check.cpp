#include "approach/motion_check.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/linear_algebra.hpp>

#include "approach/base_motion.hpp"

namespace stillbase {

StillScene::StillScene(const ApproachTask& task, std::vector<Pose> targets, double resolution)
    : problem_(task.problem),
      scene_(task.scene),
      target_scene_(task.scene.target_pairs_only()),
      goal_base_(task.goal.base),
      centroid_(goal_base_ * system_centroid(problem_.robot, compute_kinematics<double>(
                                                                 problem_.robot, task.goal.phi))),
      centroid_levers_(centroid_levers(problem_.robot)),
      targets_(std::move(targets)),
      resolution_(resolution) {}

Pose StillScene::base_at(const Kinematics<double>& kinematics) const {
  if (problem_.approach.base == BaseMode::Held) return goal_base_;
  return {centroid_ - goal_base_.orientation * system_centroid(problem_.robot, kinematics),
          goal_base_.orientation};
}

std::optional<Proximity> StillScene::first_hit(const JointVectord& phi) const {
  const auto kinematics = compute_kinematics<double>(problem_.robot, phi);
  const Pose base = base_at(kinematics);
  const double margin = least_distance(problem_.approach);
  if (auto hit = scene_.first_hit(kinematics, base, nullptr, margin)) return hit;
  for (const Pose& target : targets_) {
    if (auto hit = target_scene_.first_hit(kinematics, base, &target, margin)) return hit;
  }
  return std::nullopt;
}

bool StillScene::is_part_clear(const JointVectord& a, const JointVectord& b, double begin,
                               double end, const Unsure* before) const {
  const JointVectord phi = a + (begin + end) / 2 * (b - a);
  const auto kinematics = compute_kinematics<double>(problem_.robot, phi);
  const Pose base = base_at(kinematics);
  SceneTravel travel;
  travel.joints = (b - a).cwiseAbs() * ((end - begin) / 2);
  if (problem_.approach.base == BaseMode::Floating) {
    travel.base_translation = centroid_levers_.dot(travel.joints);
  }
  const double margin = least_distance(problem_.approach);
  SweepResult alone, beside_target;
  if (before == nullptr || !before->alone.empty()) {
    alone = scene_.sweep(kinematics, base, nullptr, travel, margin,
                         before == nullptr ? nullptr : &before->alone);
    if (alone.verdict == SweepVerdict::Hit) return false;
  }
  if (before == nullptr || !before->beside_target.empty()) {
    beside_target = target_scene_.sweep_each(kinematics, base, targets_, travel, margin,
                                             before == nullptr ? nullptr : &before->beside_target);
    if (beside_target.verdict == SweepVerdict::Hit) return false;
  }
  const bool clear =
      alone.verdict == SweepVerdict::Clear && beside_target.verdict == SweepVerdict::Clear;
  if (clear || (end - begin) * (b - a).norm() <= resolution_) return true;
  const Unsure unsure{std::move(alone.unsure), std::move(beside_target.unsure)};
  const double middle = (begin + end) / 2;
  return is_part_clear(a, b, begin, middle, &unsure) && is_part_clear(a, b, middle, end, &unsure);
}

namespace {

/// Bound on the target's rate of turning at all times: |omega| <= |L| / smallest principal moment.
double largest_rate(const TargetBody& body, const TargetState& state) {
  const double rate = state.angular_velocity.norm();
  if (body.is_point_mass || rate == 0) return rate;
  const Vector3d omega_T = state.pose.orientation.conjugate() * state.angular_velocity;
  return (body.inertia * omega_T).norm() / principal_moments(body.inertia)[0];
}

/// Follows a timed motion, the wait as a last segment without motion of the robot.
class Follower {
 public:
  Follower(const ApproachTask& task, const TimedMotion& motion, const TargetMotion* target)
      : task_(task),
        path_(motion.path),
        base_poses_(motion.base_poses),
        moving_(motion.path.segments()),
        contact_time_(motion.contact_time),
        target_(target) {
    if (contact_time_ > path_.times.back()) {
      path_.times.push_back(contact_time_);
      path_.phi.push_back(path_.phi.back());
      path_.phidot.push_back(JointVectord::Zero(path_.phi.back().size()));
      base_poses_.push_back(base_poses_.back());
    }
    if (target_ != nullptr) {
      const TargetState state = target_->state(contact_time_);
      target_speed_ = state.linear_velocity.norm();
      target_rate_ = largest_rate(target_->body(), state);
    }
  }

  std::optional<TimedHit> first_hit() const {
    for (std::size_t i = 0; i < path_.segments(); ++i) {
      if (i == moving_ && target_ == nullptr) continue;
      if (auto hit = on_segment(i, path_.times[i], path_.times[i + 1], nullptr)) return hit;
    }
    Pose storage;
    const auto hit = task_.scene.first_hit(kinematics(path_.phi.back()), base_poses_.back(),
                                           target_pose(contact_time_, storage), margin());
    if (!hit) return std::nullopt;
    return TimedHit{*hit, contact_time_};
  }

  Proximity smallest_clearance() const {
    Proximity least;
    least.distance = kInfinity;
    const auto look = [&](const JointVectord& phi, const Pose& base, double time) {
      Pose storage;
      const auto nearest = task_.scene.nearest(kinematics(phi), base, target_pose(time, storage),
                                               false, least.distance);
      if (nearest) least = *nearest;
    };
    const double step =
        std::min(task_.options.motion_check.coarsest, task_.problem.approach.resolution) / 2;
    for (std::size_t i = 0; i < path_.segments(); ++i) {
      const double t0 = path_.times[i], h = path_.times[i + 1] - t0;
      const double travel = i == moving_ ? (target_speed_ + target_rate_) * h
                                         : (peak_rates(path_, i, t0, t0 + h) * h).norm();
      const int parts = static_cast<int>(std::clamp(std::ceil(travel / step), 1.0, 10000.0));
      for (int part = 0; part < parts; ++part) {
        const double t = t0 + h * part / parts;
        look(motion_on_segment(path_, i, t).phi, base_at(i, t), t);
      }
    }
    look(path_.phi.back(), base_poses_.back(), contact_time_);
    return least;
  }

 private:
  Kinematics<double> kinematics(const JointVectord& phi) const {
    return compute_kinematics<double>(task_.problem.robot, phi);
  }
  double margin() const { return least_distance(task_.problem.approach); }
  /// Null when there is no target.
  const Pose* target_pose(double time, Pose& storage) const {
    if (target_ == nullptr) return nullptr;
    storage = target_->state(time).pose;
    return &storage;
  }
  /// Whether the base drifts during segment i.
  bool drifts(std::size_t i) const {
    return task_.problem.approach.base == BaseMode::Floating && i != moving_;
  }
  Pose base_at(std::size_t i, double t) const {
    if (!drifts(i) || t <= path_.times[i]) return base_poses_[i];
    return base_poses_[i] * base_step(task_.problem.robot, path_, i, path_.times[i], t);
  }

  /// @param among pairs that a longer part of the segment left unsure; null: every pair
  std::optional<TimedHit> on_segment(std::size_t i, double t0, double t1,
                                     const std::vector<std::size_t>* among) const {
    const MotionCheckOptions& options = task_.options.motion_check;
    const double middle = (t0 + t1) / 2, half = (t1 - t0) / 2;
    SceneTravel travel;
    travel.joints = peak_rates(path_, i, t0, t1) * half;
    travel.target_translation = target_speed_ * half;
    travel.target_rotation = target_rate_ * half;
    if (drifts(i)) {
      // Largest of three base velocities, with a margin for those between.
      for (const double t : {t0, middle, t1}) {
        const Vector6d Omega = base_velocity(task_.problem.robot, motion_on_segment(path_, i, t));
        travel.base_translation = std::max(travel.base_translation,
                                           options.velocity_margin * half * Omega.head<3>().norm());
        travel.base_rotation =
            std::max(travel.base_rotation, options.velocity_margin * half * Omega.tail<3>().norm());
      }
    }
    Pose storage;
    const SweepResult result =
        task_.scene.sweep(kinematics(motion_on_segment(path_, i, middle).phi), base_at(i, middle),
                          target_pose(middle, storage), travel, margin(), among);
    if (result.verdict == SweepVerdict::Hit) return TimedHit{result.closest, middle};
    const bool is_small =
        std::max({travel.joints.norm(), travel.base_translation, travel.base_rotation,
                  travel.target_translation, travel.target_rotation}) <=
        options.finest / 2 * std::min(options.coarsest, task_.problem.approach.resolution);
    if (result.verdict == SweepVerdict::Clear || is_small) return std::nullopt;
    if (auto hit = on_segment(i, t0, middle, &result.unsure)) return hit;
    return on_segment(i, middle, t1, &result.unsure);
  }

  const ApproachTask& task_;
  JointPath path_;
  std::vector<Pose> base_poses_;
  std::size_t moving_;  ///< number of segments on which the robot moves
  double contact_time_;
  const TargetMotion* target_;
  double target_speed_ = 0, target_rate_ = 0;
};

}  // namespace

TimedMotion waiting_motion(const Configuration& at, double wait) {
  return {{{at.contact_time - wait}, {at.phi}, {JointVectord::Zero(at.phi.size())}},
          {at.base},
          at.contact_time};
}

std::optional<TimedHit> first_hit(const ApproachTask& task, const TimedMotion& motion,
                                  const TargetMotion* target) {
  return Follower(task, motion, target).first_hit();
}

Proximity smallest_clearance(const ApproachTask& task, const TimedMotion& motion,
                             const TargetMotion* target) {
  return Follower(task, motion, target).smallest_clearance();
}

}  // namespace stillbase
