// Building a scene by the pair rules of scene.hpp, and asking it. Everything is expressed in B, so
// that self-collision does not see the base pose.
#include <stillbase/collision/scene.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/rotation.hpp>

#include "collision/closed_forms.hpp"
#include "collision/fcl_shape.hpp"
#include "plan/allowed_contacts.hpp"

namespace stillbase {

namespace {

enum class Carrier { Robot, Target, Inertial };

/// One shape and what carries it. An obstacle fixed in B is a shape of the base body.
struct Item {
  Carrier carrier;
  int body;  ///< Robot: body index
  std::string name;
  Pose pose;  ///< shape frame in the carrier's frame
  Matrix3d R;
  BoundingSphere bounds;              ///< in the carrier's frame
  BoundingBox box;                    ///< in the shape's frame
  std::optional<RoundSegment> round;  ///< in the shape's frame
  bool is_box;
  std::shared_ptr<const FclShape> fcl;
  double reach;        ///< no point is further from the carrier's origin, m
  MotionBound motion;  ///< Robot
};

struct Pair {
  std::size_t a = 0, b = 0;
  bool is_target = false;  ///< a belongs to the target
  bool is_hand_and_target = false;
  bool is_on_base = false;  ///< the base carries both
};

}  // namespace

struct CollisionScene::Data {
  std::vector<Item> items;
  std::vector<Pair> pairs;
  /// Of pairs on the base, one per column: bound on the change of their distance per motion of each
  /// joint, m/rad (1). Joints that carry both do not move one against the other.
  Eigen::MatrixXd levers;
  MotionBound most;       ///< of all items that the base carries, which holds for those levers, too
  double most_reach = 0;  ///< of all items of the target
  bool has_contact_point = false;
  Vector3d contact_point = Vector3d::Zero();  ///< in T
  double contact_radius = 0;  ///< of the sphere that is touched when there is no feature
  double contact_allowance = 0;
  MotionBound hand;

  void measure_motion() {
    levers.setZero(hand.lever.size(), static_cast<Eigen::Index>(pairs.size()));
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (!pairs[i].is_on_base) continue;
      const MotionBound &a = items[pairs[i].a].motion, &b = items[pairs[i].b].motion;
      for (Eigen::Index k = 0; k < levers.rows(); ++k) {
        if ((a.lever[k] > 0) == (b.lever[k] > 0)) continue;
        levers(k, static_cast<Eigen::Index>(i)) = std::max(a.lever[k], b.lever[k]);
      }
    }
    most = hand;
    for (const Item& item : items) {
      if (item.carrier == Carrier::Target) most_reach = std::max(most_reach, item.reach);
      if (item.carrier != Carrier::Robot) continue;
      most.lever = most.lever.cwiseMax(item.motion.lever);
      most.base_reach = std::max(most.base_reach, item.motion.base_reach);
    }
  }
};

namespace {

Item make_item(Carrier carrier, int body, const std::string& name, const Pose& pose,
               const Geometry& geometry) {
  if (!pose.is_finite() || !is_valid(geometry)) {
    throw std::invalid_argument("collision shape of " + name +
                                ": pose and sizes must be finite, sizes positive");
  }
  BoundingSphere bounds = bounding_sphere(geometry);
  bounds.centre = pose * bounds.centre;
  return {carrier,
          body,
          name,
          pose,
          pose.orientation.toRotationMatrix(),
          bounds,
          bounding_box(geometry),
          round_segment(geometry),
          std::holds_alternative<Box>(geometry),
          make_fcl_shape(geometry),
          bounds.centre.norm() + bounds.radius,
          {}};
}

/// The shapes of a joint's child and parent overlap wherever the joint stands (looked at in
/// SceneOptions::overlap_positions positions of its range): nothing that a path could avoid.
bool overlap_always(const Joint& joint, const CollisionShape& child, const CollisionShape& parent,
                    int positions) {
  const double low = std::isfinite(joint.lower) ? joint.lower : -kPi;
  const double high = std::isfinite(joint.upper) ? joint.upper : kPi;
  const auto child_fcl = make_fcl_shape(child.geometry),
             parent_fcl = make_fcl_shape(parent.geometry);
  for (int i = 0; i < positions; ++i) {
    const double phi = low + (high - low) * i / (positions - 1);
    Pose moved;
    if (joint.is_prismatic()) {
      moved.position.z() = phi;
    } else {
      moved.orientation = rotation_exp(Vector3d(0, 0, phi));
    }
    const Pose in_parent = Pose{joint.p, Eigen::Quaterniond(joint.R)} * moved * child.pose;
    if (fcl_distance(*child_fcl, in_parent.orientation.toRotationMatrix(), in_parent.position,
                     *parent_fcl, parent.pose.orientation.toRotationMatrix(),
                     parent.pose.position) > 0) {
      return false;
    }
  }
  return true;
}

/// The shapes belong to bodies joined by one joint and overlap there by construction.
bool overlap_at_joint(const RobotModel& robot, const CollisionShape& a, const CollisionShape& b,
                      const SceneOptions& options) {
  const CollisionShape& child = a.body > b.body ? a : b;
  const CollisionShape& parent = a.body > b.body ? b : a;
  if (child.body == kBase) return false;
  const Joint& joint = robot.tree()[child.body];
  if (joint.parent != parent.body) return false;
  const bool both_reach =
      point_distance(child.geometry, child.pose.inverse().position) <= options.reaches_joint &&
      point_distance(parent.geometry, parent.pose.inverse() * joint.p) <= options.reaches_joint;
  return both_reach || overlap_always(joint, child, parent, options.overlap_positions);
}

SceneParts parts_of(const CaptureProblem& problem) {
  SceneParts parts{problem.allowed_contacts, problem.obstacles, problem.target, std::nullopt,
                   problem.approach.contact_allowance};
  const std::string& name = problem.variables.feature;
  if (problem.target && !name.empty()) {
    for (const ContactFeature& feature : problem.target->features) {
      if (feature.name == name) parts.feature = feature;
    }
    if (!parts.feature) throw std::invalid_argument("target has no contact feature " + name);
  }
  return parts;
}

}  // namespace

double least_distance(const ApproachSpec& approach) {
  return std::max(0.0, approach.clearance - kDistanceTolerance);
}

std::string to_string(const Proximity& proximity) {
  return proximity.first + " with " + proximity.second;
}

MotionBound motion_bound(const RobotModel& robot, int body, double reach,
                         const SceneOptions& options) {
  MotionBound bound{JointVectord::Zero(robot.n()), reach};
  for (int k = body; k != kBase; k = robot.tree()[k].parent) {
    const Joint& joint = robot.tree()[k];
    const double stroke = std::max(std::abs(joint.lower), std::abs(joint.upper));
    const double ratio = robot.is_coupled() ? std::abs(robot.couplings[k].ratio) : 1.0;
    bound.lever[robot.coordinate(k)] += ratio * (joint.is_prismatic() ? 1.0 : bound.base_reach);
    bound.base_reach +=
        (joint.is_prismatic() ? std::min(stroke, options.unlimited_stroke) : 0) + joint.p.norm();
  }
  return bound;
}

CollisionScene::CollisionScene(const RobotModel& robot, const SceneParts& parts) {
  auto data = std::make_shared<Data>();
  std::vector<Item>& items = data->items;
  for (const CollisionShape& shape : robot.shapes) {
    items.push_back(make_item(Carrier::Robot, shape.body, shape.link, shape.pose, shape.geometry));
  }
  const std::size_t robot_count = items.size();
  for (const Obstacle& obstacle : parts.obstacles) {
    items.push_back(make_item(obstacle.frame == Frame::Base ? Carrier::Robot : Carrier::Inertial,
                              kBase, obstacle.name, obstacle.pose, obstacle.geometry));
  }
  const std::size_t target_begin = items.size();
  if (parts.target) {
    for (const TargetShape& shape : parts.target->shapes) {
      items.push_back(make_item(Carrier::Target, kBase, kTargetName, shape.pose, shape.geometry));
    }
  }
  for (Item& item : items) {
    if (item.carrier != Carrier::Robot) continue;
    item.motion = motion_bound(robot, item.body, item.reach, parts.options);
  }
  const auto add = [&](std::size_t a, std::size_t b, bool is_hand_and_target) {
    if (is_allowed(parts.allowed_contacts, items[a].name, items[b].name)) return;
    data->pairs.push_back(
        {a, b, items[a].carrier == Carrier::Target, is_hand_and_target,
         items[a].carrier == Carrier::Robot && items[b].carrier == Carrier::Robot});
  };
  for (std::size_t i = 0; i < robot_count; ++i) {
    for (std::size_t j = i + 1; j < target_begin; ++j) {
      if (items[j].carrier == Carrier::Robot && items[i].body == items[j].body) continue;
      const bool is_obstacle = j >= robot_count;
      if (!is_obstacle &&
          overlap_at_joint(robot, robot.shapes[i], robot.shapes[j], parts.options)) {
        continue;
      }
      const bool i_first = is_obstacle || items[i].body > items[j].body;
      add(i_first ? i : j, i_first ? j : i, false);
    }
  }
  for (std::size_t t = target_begin; t < items.size(); ++t) {
    for (std::size_t i = 0; i < target_begin; ++i) {
      if (items[i].carrier == Carrier::Inertial) continue;
      add(t, i, i < robot_count && items[i].body == robot.hand_body);
    }
    data->contact_radius = std::max(data->contact_radius, items[t].reach);
  }
  data->contact_allowance = parts.contact_allowance;
  data->has_contact_point = parts.feature || target_begin < items.size();
  if (parts.feature) {
    data->contact_point = parts.feature->point;
    data->contact_radius = 0;
  }
  if (!data->contact_point.allFinite() || !(data->contact_allowance >= 0)) {
    throw std::invalid_argument("contact feature and allowance must be finite");
  }
  data->hand = motion_bound(robot, robot.hand_body, robot.p_hand.norm(), parts.options);
  data->measure_motion();
  data_ = std::move(data);
}

CollisionScene::CollisionScene(const CaptureProblem& problem)
    : CollisionScene(problem.robot, parts_of(problem)) {}

CollisionScene CollisionScene::target_pairs_only() const {
  auto reduced = std::make_shared<Data>(*data_);
  std::erase_if(reduced->pairs, [](const Pair& pair) { return !pair.is_target; });
  reduced->measure_motion();
  CollisionScene scene(*this);
  scene.data_ = std::move(reduced);
  return scene;
}

int CollisionScene::pair_count() const { return static_cast<int>(data_->pairs.size()); }

std::vector<CollisionScene::ShapePair> CollisionScene::shape_pairs() const {
  std::vector<ShapePair> pairs;
  for (const Pair& pair : data_->pairs) pairs.push_back({pair.a, pair.b});
  return pairs;
}

namespace {

/// What FCL may state too little, m, see fcl_distance(): a gap that exceeds it by more than that is
/// one by FCL's distance, too.
constexpr double kFclError = 1e-5;

/// Shapes of a scene that need no heap.
constexpr std::size_t kItemsInPlace = 32;

/// A shape placed in B.
struct Placed {
  Matrix3d R;
  Vector3d p;
  Vector3d round_a, round_b;  ///< ends of the segment of spheres and capsules
};

/// All shapes in B at one instant, and the hand's distance from where it will touch. Most pairs are
/// far apart by their bounding spheres: shapes are placed where a pair asks for them.
class Instant {
 public:
  Instant(const CollisionScene::Data& data, const Kinematics<double>& kinematics, const Pose& base,
          const Pose* target)
      : data_(data), kinematics_(kinematics), T_BN_(base.inverse()) {
    R_BN_ = T_BN_.orientation.toRotationMatrix();
    centres_.resize(data.items.size());
    placed_.resize(data.items.size());
    is_placed_.resize(data.items.size());
    for (std::size_t i = 0; i < data.items.size(); ++i) {
      if (data.items[i].carrier != Carrier::Target) put_centre(i);
    }
    if (target != nullptr) put_target(*target);
  }

  /// The same with the target there.
  void put_target(const Pose& target) {
    has_target_ = true;
    const Pose T_BT = T_BN_ * target;
    R_BT_ = T_BT.orientation.toRotationMatrix();
    p_BT_ = T_BT.position;
    const Vector3d contact = R_BT_ * data_.contact_point + p_BT_;
    hand_to_contact = std::max((kinematics_.r_bh - contact).norm() - data_.contact_radius, 0.0);
    require_finite(std::isfinite(hand_to_contact));
    for (std::size_t i = 0; i < data_.items.size(); ++i) {
      if (data_.items[i].carrier == Carrier::Target) put_centre(i);
    }
  }

  /// Whether the target is there, where the pair needs it.
  bool is_present(const Pair& pair) const { return has_target_ || !pair.is_target; }
  /// The pair may touch now.
  bool may_touch(const Pair& pair) const {
    return pair.is_hand_and_target && data_.has_contact_point &&
           hand_to_contact <= data_.contact_allowance;
  }

  /// By their bounding spheres a pair is further apart than `distance`.
  bool is_beyond(const Pair& pair, double distance) const {
    const double reach =
        distance + data_.items[pair.a].bounds.radius + data_.items[pair.b].bounds.radius;
    return reach < 0 || (centres_[pair.a] - centres_[pair.b]).squaredNorm() > reach * reach;
  }

  /// Distance of a pair, or another number above `enough` when it is above.
  double distance(const Pair& pair, double enough) {
    return is_beyond(pair, enough) ? kInfinity : distance_of_near(pair, enough);
  }

  /// Distance of a pair, or a lower bound of it that is above `enough`.
  double distance_of_near(const Pair& pair, double enough) {
    const Item &a = data_.items[pair.a], &b = data_.items[pair.b];
    const Placed &pa = placed(pair.a), &pb = placed(pair.b);
    if (a.round && b.round) return round_distance(round_of(pair.a), round_of(pair.b));
    if (a.round && b.is_box) return round_box_distance(round_of(pair.a), {b.box.half, pb.R, pb.p});
    if (a.is_box && b.round) return round_box_distance(round_of(pair.b), {a.box.half, pa.R, pa.p});
    const double gap = box_gap({a.box.half, pa.R, pa.R * a.box.centre + pa.p},
                               {b.box.half, pb.R, pb.R * b.box.centre + pb.p});
    if (gap > enough + kFclError) return gap;
    if (a.is_box && b.is_box) {
      const double widest = widest_gap({a.box.half, pa.R, pa.p}, {b.box.half, pb.R, pb.p});
      if (widest > enough + kFclError) return widest;
    }
    return fcl_distance(*a.fcl, pa.R, pa.p, *b.fcl, pb.R, pb.p);
  }

  /// The closest points of a pair, in B.
  std::optional<PointPair> points(const Pair& pair) {
    const Placed &a = placed(pair.a), &b = placed(pair.b);
    return fcl_nearest_points(*data_.items[pair.a].fcl, a.R, a.p, *data_.items[pair.b].fcl, b.R,
                              b.p);
  }

  double hand_to_contact = 0;

 private:
  /// FCL would end the process.
  static void require_finite(bool is_finite) {
    if (!is_finite) throw std::invalid_argument("collision query with a pose that is not finite");
  }

  void put_centre(std::size_t i) {
    is_placed_[i] = false;
    const Item& item = data_.items[i];
    with_carrier(item, [&](const Matrix3d& R, const Vector3d& p) {
      centres_[i] = R * item.bounds.centre + p;
    });
    require_finite(centres_[i].allFinite());
  }

  /// Calls take(R, p) with the pose of what carries the item, in B.
  template <class Take>
  void with_carrier(const Item& item, Take take) const {
    if (item.carrier == Carrier::Target) {
      take(R_BT_, p_BT_);
    } else if (item.carrier == Carrier::Inertial) {
      take(R_BN_, T_BN_.position);
    } else if (item.body == kBase) {
      take(Matrix3d::Identity(), Vector3d::Zero());
    } else {
      take(kinematics_.R[item.body], kinematics_.o[item.body]);
    }
  }

  const Placed& placed(std::size_t i) {
    Placed& out = placed_[i];
    if (is_placed_[i]) return out;
    is_placed_[i] = true;
    const Item& item = data_.items[i];
    with_carrier(item, [&](const Matrix3d& R, const Vector3d& p) {
      out.R.noalias() = R * item.R;
      out.p = R * item.pose.position + p;
    });
    if (item.round) {
      out.round_a = out.R * item.round->a + out.p;
      out.round_b = out.R * item.round->b + out.p;
    }
    return out;
  }

  /// Of a sphere or capsule that is placed.
  RoundSegment round_of(std::size_t i) const {
    return {placed_[i].round_a, placed_[i].round_b, data_.items[i].round->radius};
  }

  const CollisionScene::Data& data_;
  const Kinematics<double>& kinematics_;
  bool has_target_ = false;
  Pose T_BN_;
  Matrix3d R_BN_, R_BT_;
  Vector3d p_BT_;
  InPlaceArray<Vector3d, kItemsInPlace> centres_;  ///< of the bounding spheres
  InPlaceArray<Placed, kItemsInPlace> placed_;
  InPlaceArray<bool, kItemsInPlace> is_placed_;
};

Proximity proximity(const CollisionScene::Data& data, const Pair& pair, double distance) {
  return {data.items[pair.a].name, data.items[pair.b].name, distance};
}

/// The closest pair that may not touch and its distance; null: there is none.
std::pair<const Pair*, double> closest_pair(const CollisionScene::Data& data, Instant& instant,
                                            bool with_hand_and_target, double least = kInfinity) {
  const Pair* closest = nullptr;
  for (const Pair& pair : data.pairs) {
    if (!instant.is_present(pair) || instant.may_touch(pair) ||
        (pair.is_hand_and_target && !with_hand_and_target)) {
      continue;
    }
    const double distance = instant.distance(pair, least);
    if (distance < least) {
      least = distance;
      closest = &pair;
    }
  }
  return {closest, least};
}

/// Motion in N of a point that the base carries.
double motion_with_base(const MotionBound& bound, const SceneTravel& travel) {
  return bound.lever.dot(travel.joints) + travel.base_translation +
         travel.base_rotation * bound.base_reach;
}

/// How far any point of the item moves in N.
double motion_in_inertial(const Item& item, const SceneTravel& travel) {
  if (item.carrier == Carrier::Robot) return motion_with_base(item.motion, travel);
  if (item.carrier == Carrier::Inertial) return 0;
  return travel.target_translation + travel.target_rotation * item.reach;
}

/// Bounds on how much the distances of pairs can change.
class PairMotion {
 public:
  PairMotion(const CollisionScene::Data& data, const SceneTravel& travel)
      : data_(data),
        travel_(travel),
        most_(2 * motion_with_base(data.most, travel) + travel.target_translation +
              travel.target_rotation * data.most_reach) {}

  /// Of any pair.
  double most() const { return most_; }
  /// Of the pair with that number.
  double of(std::size_t i) const {
    const Pair& pair = data_.pairs[i];
    if (!pair.is_on_base) {
      return motion_in_inertial(data_.items[pair.a], travel_) +
             motion_in_inertial(data_.items[pair.b], travel_);
    }
    return data_.levers.col(static_cast<Eigen::Index>(i)).dot(travel_.joints);
  }

 private:
  const CollisionScene::Data& data_;
  const SceneTravel& travel_;
  double most_;
};

/// See CollisionScene::sweep().
SweepResult sweep_pairs(const CollisionScene::Data& data, Instant& instant,
                        const PairMotion& motions, const SceneTravel& travel, double margin) {
  SweepResult result;
  double smallest_reserve = 0;
  for (std::size_t i = 0; i < data.pairs.size(); ++i) {
    const Pair& pair = data.pairs[i];
    if (!instant.is_present(pair)) continue;
    const bool may_touch = instant.may_touch(pair);
    if (!may_touch && instant.is_beyond(pair, margin + motions.most())) continue;
    const double motion = motions.of(i);
    double reserve = kInfinity;  // how much more the pair could have moved
    double distance = 0;
    if (may_touch) {
      // The hand may touch now; is that so during the whole interval?
      reserve = data.contact_allowance - instant.hand_to_contact -
                (motion_with_base(data.hand, travel) + travel.target_translation +
                 travel.target_rotation * data.contact_point.norm());
      if (reserve >= 0) continue;
    }
    if (reserve == kInfinity) {
      if (instant.is_beyond(pair, margin + motion)) continue;
      // A bound will do: what it leaves unsure is looked at again, with less motion.
      distance = instant.distance_of_near(pair, margin);
      if (distance <= 0 || distance < margin) {
        return {SweepVerdict::Hit, proximity(data, pair, distance)};
      }
      reserve = distance - margin - motion;
    }
    if (reserve < smallest_reserve) {
      smallest_reserve = reserve;
      result = {SweepVerdict::Unsure, proximity(data, pair, distance)};
    }
  }
  return result;
}

}  // namespace

std::optional<Proximity> CollisionScene::first_hit(const Kinematics<double>& kinematics,
                                                   const Pose& base, const Pose* target,
                                                   double margin) const {
  Instant instant(*data_, kinematics, base, target);
  for (const Pair& pair : data_->pairs) {
    if (!instant.is_present(pair) || instant.may_touch(pair)) continue;
    const double distance = instant.distance(pair, std::max(margin, 0.0));
    if (distance <= 0 || distance < margin) return proximity(*data_, pair, distance);
  }
  return std::nullopt;
}

std::optional<Proximity> CollisionScene::nearest(const Kinematics<double>& kinematics,
                                                 const Pose& base, const Pose* target,
                                                 bool with_hand_and_target, double below) const {
  Instant instant(*data_, kinematics, base, target);
  const auto [pair, distance] = closest_pair(*data_, instant, with_hand_and_target, below);
  if (pair == nullptr) return std::nullopt;
  return proximity(*data_, *pair, distance);
}

std::optional<NearestPoints> CollisionScene::nearest_points(const Kinematics<double>& kinematics,
                                                            const Pose& base, const Pose* target,
                                                            bool with_hand_and_target) const {
  Instant instant(*data_, kinematics, base, target);
  const auto [pair, distance] = closest_pair(*data_, instant, with_hand_and_target);
  const auto points = pair == nullptr ? std::nullopt : instant.points(*pair);
  if (!points) return std::nullopt;
  return NearestPoints{proximity(*data_, *pair, distance), points->front(), points->back()};
}

SweepResult CollisionScene::sweep(const Kinematics<double>& kinematics, const Pose& base,
                                  const Pose* target, const SceneTravel& travel,
                                  double margin) const {
  Instant instant(*data_, kinematics, base, target);
  return sweep_pairs(*data_, instant, PairMotion(*data_, travel), travel, margin);
}

SweepVerdict CollisionScene::sweep_each(const Kinematics<double>& kinematics, const Pose& base,
                                        const std::vector<Pose>& targets, const SceneTravel& travel,
                                        double margin) const {
  Instant instant(*data_, kinematics, base, nullptr);
  const PairMotion motions(*data_, travel);
  SweepVerdict out = SweepVerdict::Clear;
  for (const Pose& target : targets) {
    instant.put_target(target);
    const SweepVerdict verdict = sweep_pairs(*data_, instant, motions, travel, margin).verdict;
    if (verdict == SweepVerdict::Hit) return verdict;
    if (verdict == SweepVerdict::Unsure) out = verdict;
  }
  return out;
}

}  // namespace stillbase
