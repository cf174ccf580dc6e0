#include "approach/motion_check.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/linear_algebra.hpp>

#include "approach/base_motion.hpp"

namespace stillbase {

StillScene::StillScene(const CaptureProblem& problem, const CollisionScene& scene,
                       const Configuration& goal, std::vector<Pose> targets, double resolution)
    : problem_(problem),
      scene_(scene),
      target_scene_(scene.target_pairs_only()),
      goal_base_(goal.base),
      centroid_levers_(centroid_levers(problem.robot)),
      targets_(std::move(targets)),
      resolution_(resolution) {
  centroid_ = goal.base *
              system_centroid(problem.robot, compute_kinematics<double>(problem.robot, goal.phi));
}

Pose StillScene::base_at(const Kinematics<double>& kinematics) const {
  if (problem_.approach.base == BaseMode::Held) return goal_base_;
  return {centroid_ - goal_base_.orientation * system_centroid(problem_.robot, kinematics),
          goal_base_.orientation};
}

std::optional<Proximity> StillScene::first_hit(const JointVectord& phi) const {
  const auto kinematics = compute_kinematics<double>(problem_.robot, phi);
  const Pose base = base_at(kinematics);
  const double margin = problem_.approach.clearance;
  if (auto hit = scene_.first_hit(kinematics, base, nullptr, margin)) return hit;
  for (const Pose& target : targets_) {
    if (auto hit = target_scene_.first_hit(kinematics, base, &target, margin)) return hit;
  }
  return std::nullopt;
}

bool StillScene::is_motion_clear(const JointVectord& a, const JointVectord& b) const {
  return is_clear_between(a, b, 0, 1);
}

bool StillScene::is_clear_between(const JointVectord& a, const JointVectord& b, double begin,
                                  double end) const {
  const JointVectord phi = a + (begin + end) / 2 * (b - a);
  const auto kinematics = compute_kinematics<double>(problem_.robot, phi);
  const Pose base = base_at(kinematics);
  SceneTravel travel;
  travel.joints = (b - a).cwiseAbs() * ((end - begin) / 2);
  if (problem_.approach.base == BaseMode::Floating) {
    travel.base_translation = centroid_levers_.dot(travel.joints);
  }
  bool clear = true;
  const auto look = [&](const CollisionScene& scene, const Pose* target) {
    const SweepVerdict verdict =
        scene.sweep(kinematics, base, target, travel, problem_.approach.clearance).verdict;
    clear = clear && verdict == SweepVerdict::Clear;
    return verdict != SweepVerdict::Hit;
  };
  if (!look(scene_, nullptr)) return false;
  for (const Pose& target : targets_) {
    if (!look(target_scene_, &target)) return false;
  }
  if (clear || (end - begin) * (b - a).norm() <= resolution_) return true;
  const double middle = (begin + end) / 2;
  return is_clear_between(a, b, begin, middle) && is_clear_between(a, b, middle, end);
}

namespace {

/// Bound on the target's rate of turning at all times: |omega| <= |L| / smallest principal moment.
double largest_rate(const TargetMotion& target, double time) {
  const TargetState state = target.state(time);
  const Matrix3d& inertia = target.body().inertia;
  const double rate = state.angular_velocity.norm();
  if (target.body().is_point_mass || rate == 0) return rate;
  const Vector3d omega_T = state.pose.orientation.conjugate() * state.angular_velocity;
  return (inertia * omega_T).norm() / principal_moments(inertia)[0];
}

/// Follows a timed motion; each interval is proven clear or split.
class Follower {
 public:
  Follower(const CaptureProblem& problem, const CollisionScene& scene, const TimedMotion& motion,
           const TargetMotion* target)
      : problem_(problem), scene_(scene), motion_(motion), target_(target) {
    if (target_ != nullptr) {
      const TargetState state = target_->state(motion.contact_time);
      target_speed_ = state.linear_velocity.norm();
      target_rate_ = largest_rate(*target_, motion.contact_time);
    }
  }

  std::optional<TimedHit> first_hit() const {
    const JointPath& path = motion_.path;
    for (std::size_t i = 0; i < path.segments(); ++i) {
      if (auto hit = on_segment(i, path.times[i], path.times[i + 1])) return hit;
    }
    const double arrival = path.times.back();
    if (motion_.contact_time > arrival && target_ != nullptr) {
      if (auto hit = waiting(arrival, motion_.contact_time)) return hit;
    }
    return at(path.phi.back(), motion_.base_poses.back(), motion_.contact_time);
  }

  Proximity smallest_clearance() const {
    Proximity least;
    least.distance = kInfinity;
    const auto look = [&](const JointVectord& phi, const Pose& base, double time) {
      const Pose pose = target_pose(time);
      const auto nearest = scene_.nearest(compute_kinematics<double>(problem_.robot, phi), base,
                                          target_ != nullptr ? &pose : nullptr, false);
      if (nearest && nearest->distance < least.distance) least = *nearest;
    };
    const double step = problem_.approach.resolution / 2;
    const JointPath& path = motion_.path;
    for (std::size_t i = 0; i < path.segments(); ++i) {
      const double t0 = path.times[i], h = path.times[i + 1] - t0;
      const int parts = parts_for((peak_rates(path, i, t0, t0 + h) * h).norm() / step);
      for (int part = 0; part < parts; ++part) {
        const double t = t0 + h * part / parts;
        look(motion_on_segment(path, i, t).phi, base_at(i, t), t);
      }
    }
    const double arrival = path.times.back(), wait = motion_.contact_time - arrival;
    const int parts = parts_for((target_speed_ + target_rate_) * wait / step);
    for (int part = 0; part <= parts; ++part) {
      look(path.phi.back(), motion_.base_poses.back(), arrival + wait * part / parts);
    }
    return least;
  }

 private:
  static int parts_for(double ratio) {
    return static_cast<int>(std::clamp(std::ceil(ratio), 1.0, 10000.0));
  }

  Pose target_pose(double time) const {
    return target_ != nullptr ? target_->state(time).pose : Pose{};
  }

  bool floating() const { return problem_.approach.base == BaseMode::Floating; }

  Pose base_at(std::size_t i, double t) const {
    const Pose& begin = motion_.base_poses[i];
    if (!floating() || t <= motion_.path.times[i]) return begin;
    return begin * base_step(problem_.robot, motion_.path, i, motion_.path.times[i], t);
  }

  std::optional<TimedHit> at(const JointVectord& phi, const Pose& base, double time) const {
    const Pose pose = target_pose(time);
    const auto hit =
        scene_.first_hit(compute_kinematics<double>(problem_.robot, phi), base,
                         target_ != nullptr ? &pose : nullptr, problem_.approach.clearance);
    if (!hit) return std::nullopt;
    return TimedHit{*hit, time};
  }

  SceneTravel target_travel(double half) const {
    SceneTravel travel;
    travel.joints = JointVectord::Zero(problem_.robot.n());
    travel.target_translation = target_speed_ * half;
    travel.target_rotation = target_rate_ * half;
    return travel;
  }

  bool is_small(const SceneTravel& travel) const {
    return std::max({travel.joints.norm(), travel.base_translation, travel.base_rotation,
                     travel.target_translation, travel.target_rotation}) <=
           problem_.approach.resolution / 16;
  }

  std::optional<TimedHit> on_segment(std::size_t i, double t0, double t1) const {
    const double middle = (t0 + t1) / 2, half = (t1 - t0) / 2;
    const JointMotion motion = motion_on_segment(motion_.path, i, middle);
    const Pose base = base_at(i, middle), target = target_pose(middle);
    SceneTravel travel = target_travel(half);
    travel.joints = peak_rates(motion_.path, i, t0, t1) * half;
    if (floating()) {
      // Largest of three base velocities; half as much again for what lies between.
      for (const double t : {t0, middle, t1}) {
        const Vector6d Omega = base_velocity(problem_.robot, motion_on_segment(motion_.path, i, t));
        travel.base_translation =
            std::max(travel.base_translation, 1.5 * half * Omega.head<3>().norm());
        travel.base_rotation = std::max(travel.base_rotation, 1.5 * half * Omega.tail<3>().norm());
      }
    }
    const SweepResult result =
        scene_.sweep(compute_kinematics<double>(problem_.robot, motion.phi), base,
                     target_ != nullptr ? &target : nullptr, travel, problem_.approach.clearance);
    if (result.verdict == SweepVerdict::Hit) return TimedHit{result.closest, middle};
    if (result.verdict == SweepVerdict::Clear || is_small(travel)) return std::nullopt;
    if (auto hit = on_segment(i, t0, middle)) return hit;
    return on_segment(i, middle, t1);
  }

  std::optional<TimedHit> waiting(double t0, double t1) const {
    const double middle = (t0 + t1) / 2;
    const SceneTravel travel = target_travel((t1 - t0) / 2);
    const Pose target = target_pose(middle);
    const SweepResult result =
        scene_.sweep(compute_kinematics<double>(problem_.robot, motion_.path.phi.back()),
                     motion_.base_poses.back(), &target, travel, problem_.approach.clearance);
    if (result.verdict == SweepVerdict::Hit) return TimedHit{result.closest, middle};
    if (result.verdict == SweepVerdict::Clear || is_small(travel)) return std::nullopt;
    if (auto hit = waiting(t0, middle)) return hit;
    return waiting(middle, t1);
  }

  const CaptureProblem& problem_;
  const CollisionScene& scene_;
  const TimedMotion& motion_;
  const TargetMotion* target_;
  double target_speed_ = 0, target_rate_ = 0;
};

}  // namespace

TimedMotion waiting_motion(const Configuration& at, double wait) {
  return {{{at.contact_time - wait}, {at.phi}, {JointVectord::Zero(at.phi.size())}},
          {at.base},
          at.contact_time};
}

std::optional<TimedHit> first_hit(const CaptureProblem& problem, const CollisionScene& scene,
                                  const TimedMotion& motion, const TargetMotion* target) {
  return Follower(problem, scene, motion, target).first_hit();
}

Proximity smallest_clearance(const CaptureProblem& problem, const CollisionScene& scene,
                             const TimedMotion& motion, const TargetMotion* target) {
  return Follower(problem, scene, motion, target).smallest_clearance();
}

}  // namespace stillbase
