#include "verification/clearance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/linear_algebra.hpp>

#include "verification/moving_shapes.hpp"

namespace stillbase::verification {
namespace {

/// The scene's view of a posture, filled from the reference kinematics.
Kinematics<double> kinematics_at(const RobotModel& robot, const Eigen::VectorXd& phi) {
  Kinematics<double> kinematics;
  kinematics.n = robot.num_bodies();
  for (auto* points : {&kinematics.o, &kinematics.c}) points->resize(robot.bodies.size());
  kinematics.R.resize(robot.bodies.size());
  const std::vector<Pose> poses = reference::body_poses(robot, phi);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    kinematics.R[k] = poses[k].orientation.toRotationMatrix();
    kinematics.o[k] = poses[k].position;
    kinematics.c[k] = poses[k] * robot.bodies[k].centroid;
  }
  const Pose hand_body = robot.hand_body == kBase ? Pose{} : poses[robot.hand_body];
  kinematics.R_hand = hand_body.orientation.toRotationMatrix() * robot.R_hand;
  kinematics.r_bh = hand_body * robot.p_hand;
  return kinematics;
}

/// Bound of the target's angular rate at any time, rad/s: the angular momentum over the smallest
/// principal moment.
double target_rate(const TargetMotion& motion, double time) {
  const TargetState state = motion.state(time);
  const double rate = state.angular_velocity.norm();
  if (motion.body().is_point_mass || rate == 0) return rate;
  const Matrix3d& inertia = motion.body().inertia;
  const Vector3d omega_T = state.pose.orientation.conjugate() * state.angular_velocity;
  return (inertia * omega_T).norm() / principal_moments(inertia)[0];
}

/// When the search along a path ends.
struct PathSearchOptions {
  long most_instants = 1'000'000;  ///< shipped problems take some 20 000
  double finest = 1e-5;            ///< m of motion: a part of the path is not split further
};
constexpr PathSearchOptions kPathSearch;

/// The search of path_clearance().
class PathSearch {
 public:
  PathSearch(const Context& context, const Approach& path, const TargetMotion* target,
             const std::vector<BaseTrack>& tracks)
      : context_(context),
        approach_(path),
        tracks_(tracks),
        target_(target),
        scene_(context.problem),
        shapes_(context.problem, scene_) {
    if (target_ == nullptr) return;
    const double contact = approach_.times.back();
    target_speed_ = target_->state(contact).linear_velocity.norm();
    target_rate_ = target_rate(*target_, contact);
  }

  PathClearance run() {
    for (std::size_t i = 0; i < approach_.times.size(); ++i) look_at_sample(i);
    std::vector<int> pairs(static_cast<std::size_t>(shapes_.pair_count()));
    std::iota(pairs.begin(), pairs.end(), 0);
    for (std::size_t i = 0; i < tracks_.size() && !is_over_; ++i) {
      const HermiteSegment segment(approach_, i);
      prove(segment, tracks_[i], 0, segment.duration(), pairs);
    }
    for (std::size_t i = 0; i < tracks_.size() && !is_stopped_; ++i) look_as_stated(i);
    if (is_stopped_) {
      result_.detail = "stopped";
      return result_;
    }
    nearest_as_stated(approach_.joint_positions.back(), approach_.base_poses.back(),
                      approach_.times.back());
    // Where shapes overlap, the rest of the path was not looked at.
    for (LeastDistance* least : {&of_path_, &of_hand_}) {
      least->proven = std::min(least->proven, least->found);
      if (is_over_) least->proven = std::min({least->proven, of_path_.found, of_hand_.found});
    }
    result_.of_path = of_path_;
    result_.least = of_hand_.found < of_path_.found ? of_hand_ : of_path_;
    result_.least.proven = std::min(of_hand_.proven, of_path_.proven);
    result_.complete = true;
    return result_;
  }

 private:
  std::optional<Pose> target_at(double time) const {
    if (target_ == nullptr) return std::nullopt;
    return target_->state(time).pose;
  }

  void place(const Eigen::VectorXd& phi, const Pose& base, double time) {
    ++result_.instants;
    const std::optional<Pose> target = target_at(time);
    shapes_.place(phi, base, target ? &*target : nullptr);
  }

  bool may_touch(int pair) const {
    return shapes_.is_hand_and_target(pair) && shapes_.hand_room() >= 0;
  }

  /// What distances of this pair are held against.
  double smallest_found(int pair) const {
    if (!shapes_.is_hand_and_target(pair)) return of_path_.found;
    return std::min(of_path_.found, of_hand_.found);
  }
  LeastDistance& least_of(int pair) {
    return shapes_.is_hand_and_target(pair) ? of_hand_ : of_path_;
  }

  void take(int pair, double distance, double time) {
    LeastDistance& least = least_of(pair);
    if (!(distance < least.found)) return;
    least.found = distance;
    least.time = time;
    least.pair = shapes_.name(pair);
    is_over_ = is_over_ || distance <= 0;
  }

  /// The smallest distances at a sample, by both codes.
  void look_at_sample(std::size_t i) {
    const double time = approach_.times[i];
    const Eigen::VectorXd phi = approach_.joint_positions[i];
    const Pose& base = approach_.base_poses[i];
    place(phi, base, time);
    double smallest = kInfinity;
    for (int pair = 0; pair < shapes_.pair_count(); ++pair) {
      if (!shapes_.is_present(pair) || may_touch(pair)) continue;
      const double distance = shapes_.distance(pair, smallest).upper;
      smallest = std::min(smallest, distance);
      take(pair, distance, time);
    }
    const std::optional<Pose> target = target_at(time);
    const auto other = scene_.nearest(kinematics_at(context_.problem.robot, phi), base,
                                      target ? &*target : nullptr);
    const double difference =
        other ? std::abs(std::max(other->distance, 0.0) - std::max(smallest, 0.0))
              : (smallest < kInfinity ? kInfinity : 0);
    if (difference <= result_.difference_of_codes) return;
    result_.difference_of_codes = difference;
    result_.differs_most =
        fmt::format("{} at {:.3f} s", other ? to_string(*other) : "no pair", time);
  }

  /// No distance of these pairs within [s0, s1] is below `proven`.
  void prove(const HermiteSegment& segment, const BaseTrack& track, double s0, double s1,
             const std::vector<int>& pairs) {
    is_stopped_ = is_stopped_ || context_.options.stop.reached();
    if (is_over_ || is_stopped_) return;
    if (result_.instants >= kPathSearch.most_instants) {
      throw std::invalid_argument(
          fmt::format("undecided after {} instants", kPathSearch.most_instants));
    }
    const double middle = (s0 + s1) / 2, half = (s1 - s0) / 2;
    PathTravel travel;
    travel.joints = segment.peak_rates(s0, s1) * half;
    travel.base = track.bound(s0, s1, travel.joints);
    travel.target_translation = target_speed_ * half;
    travel.target_rotation = target_rate_ * half;
    place(segment.position(middle), track.pose(middle), segment.begin() + middle);
    std::vector<int> open;
    for (const int pair : pairs) {
      if (!shapes_.is_present(pair)) continue;
      const bool may = may_touch(pair);
      if (may && shapes_.hand_room() >= shapes_.hand_motion(travel)) continue;
      const double motion = shapes_.motion(pair, travel);
      if (!std::isfinite(motion)) throw std::invalid_argument("a motion that is not finite");
      const DistanceBounds distance = shapes_.distance(pair, smallest_found(pair) + motion);
      if (!may) take(pair, distance.upper, segment.begin() + middle);
      const double proven = distance.lower - motion, found = smallest_found(pair);
      const double gap = std::min(context_.options.clearance_gap, found / 2);
      if (proven < found - gap && motion > kPathSearch.finest) {
        open.push_back(pair);
      } else {
        least_of(pair).proven = std::min(least_of(pair).proven, proven);
      }
    }
    if (open.empty()) return;
    prove(segment, track, s0, middle, open);
    prove(segment, track, middle, s1, open);
  }

  void nearest_as_stated(const Eigen::VectorXd& phi, const Pose& base, double time) {
    const std::optional<Pose> target = target_at(time);
    const auto nearest = scene_.nearest(kinematics_at(context_.problem.robot, phi), base,
                                        target ? &*target : nullptr, false);
    std::optional<double>& least = result_.distance_as_stated;
    if (nearest && (!least || nearest->distance < *least)) least = nearest->distance;
  }

  void look_as_stated(std::size_t i) {
    is_stopped_ = is_stopped_ || context_.options.stop.reached();
    const HermiteSegment segment(approach_, i);
    const double h = segment.duration();
    double length = (segment.peak_rates(0, h) * h).norm();
    // The wait is the last segment, or the last one before the run of a hand that moves.
    const bool may_wait = i + 1 == tracks_.size() || context_.problem.hand_motion.moves();
    if (length == 0 && may_wait) length = (target_speed_ + target_rate_) * h;
    const double steps = std::ceil(length / (context_.problem.approach.resolution / 2));
    const int count = static_cast<int>(std::clamp(steps, 1.0, 10000.0));
    for (int j = 0; j < count; ++j) {
      const double s = h * j / count;
      nearest_as_stated(segment.position(s), tracks_[i].pose(s), segment.begin() + s);
    }
  }

  const Context& context_;
  const Approach& approach_;
  const std::vector<BaseTrack>& tracks_;
  const TargetMotion* target_;
  CollisionScene scene_;
  MovingShapes shapes_;
  double target_speed_ = 0, target_rate_ = 0;  ///< m/s, rad/s
  LeastDistance of_path_, of_hand_;            ///< without hand against target; these alone
  bool is_over_ = false;                       ///< shapes overlap
  bool is_stopped_ = false;
  PathClearance result_;
};

}  // namespace

PathClearance path_clearance(const Context& context, const std::vector<BaseTrack>& tracks) {
  return path_clearance(context, context.plan.approach, context.situation.target(), tracks);
}

PathClearance path_clearance(const Context& context, const Approach& path,
                             const TargetMotion* target, const std::vector<BaseTrack>& tracks) {
  try {
    return PathSearch(context, path, target, tracks).run();
  } catch (const std::invalid_argument& error) {
    PathClearance refused;
    refused.detail = error.what();
    return refused;
  }
}

std::optional<Proximity> contact_collision(const CaptureProblem& problem,
                                           const CollisionScene& scene,
                                           const Configuration& configuration) {
  const Kinematics<double> kinematics = kinematics_at(problem.robot, configuration.phi);
  const auto motion = target_motion(problem, configuration, configuration.base * kinematics.r_bh,
                                    configuration.contact_time);
  std::optional<Pose> target;
  if (motion) target = motion->state(configuration.contact_time).pose;
  return scene.first_hit(kinematics, configuration.base, target ? &*target : nullptr);
}

}  // namespace stillbase::verification
