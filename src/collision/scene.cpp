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
  BoundingSphere bounds;              ///< in the shape's frame
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
  /// Of two shapes that the base carries: bound on the change of their distance per motion of each
  /// joint, m/rad (1). Joints that carry both do not move one against the other.
  std::vector<double> levers = {};
};

/// See Pair::levers.
std::vector<double> levers_between(const Item& a, const Item& b) {
  if (a.carrier != Carrier::Robot || b.carrier != Carrier::Robot) return {};
  std::vector<double> levers;
  for (Eigen::Index k = 0; k < a.motion.lever.size(); ++k) {
    const double of_a = a.motion.lever[k], of_b = b.motion.lever[k];
    levers.push_back((of_a > 0) != (of_b > 0) ? std::max(of_a, of_b) : 0);
  }
  return levers;
}

}  // namespace

struct CollisionScene::Data {
  std::vector<Item> items;
  std::vector<Pair> pairs;
  bool has_contact_point = false;
  Vector3d contact_point = Vector3d::Zero();  ///< in T
  double contact_radius = 0;  ///< of the sphere that is touched when there is no feature
  double contact_allowance = 0;
  MotionBound hand;
};

namespace {

Item make_item(Carrier carrier, int body, const std::string& name, const Pose& pose,
               const Geometry& geometry) {
  if (!pose.is_finite() || !is_valid(geometry)) {
    throw std::invalid_argument("collision shape of " + name +
                                ": pose and sizes must be finite, sizes positive");
  }
  const BoundingSphere bounds = bounding_sphere(geometry);
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
          (pose * bounds.centre).norm() + bounds.radius,
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
    data->pairs.push_back({a, b, items[a].carrier == Carrier::Target, is_hand_and_target,
                           levers_between(items[a], items[b])});
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
  data_ = std::move(data);
}

CollisionScene::CollisionScene(const CaptureProblem& problem)
    : CollisionScene(problem.robot, parts_of(problem)) {}

CollisionScene CollisionScene::target_pairs_only() const {
  auto reduced = std::make_shared<Data>(*data_);
  std::erase_if(reduced->pairs, [](const Pair& pair) { return !pair.is_target; });
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
  Vector3d centre;            ///< of the bounding sphere
  Vector3d round_a, round_b;  ///< ends of the segment of spheres and capsules
};

/// All shapes in B at one instant, and the hand's distance from where it will touch.
class Instant {
 public:
  Instant(const CollisionScene::Data& data, const Kinematics<double>& kinematics, const Pose& base,
          const Pose* target)
      : data_(data), has_target_(target != nullptr) {
    const Pose T_BN = base.inverse();
    const Matrix3d R_BN = T_BN.orientation.toRotationMatrix();
    const Pose T_BT = target != nullptr ? T_BN * *target : Pose{};
    const Matrix3d R_BT = T_BT.orientation.toRotationMatrix();
    if (target != nullptr) {
      const Vector3d contact = R_BT * data.contact_point + T_BT.position;
      hand_to_contact = std::max((kinematics.r_bh - contact).norm() - data.contact_radius, 0.0);
    }
    placed_.resize(data.items.size());
    bool finite = std::isfinite(hand_to_contact);
    for (std::size_t i = 0; i < data.items.size(); ++i) {
      const Item& item = data.items[i];
      Placed& placed = placed_[i];
      if (item.carrier == Carrier::Target) {
        place(item, R_BT, T_BT.position, placed);
      } else if (item.carrier == Carrier::Inertial) {
        place(item, R_BN, T_BN.position, placed);
      } else if (item.body == kBase) {
        place(item, Matrix3d::Identity(), Vector3d::Zero(), placed);
      } else {
        place(item, kinematics.R[item.body], kinematics.o[item.body], placed);
      }
      finite = finite && placed.R.allFinite() && placed.p.allFinite();
    }
    // FCL would end the process.
    if (!finite) throw std::invalid_argument("collision query with a pose that is not finite");
  }

  /// Whether the target is there, where the pair needs it.
  bool is_present(const Pair& pair) const { return has_target_ || !pair.is_target; }
  /// The pair may touch now.
  bool may_touch(const Pair& pair) const {
    return pair.is_hand_and_target && data_.has_contact_point &&
           hand_to_contact <= data_.contact_allowance;
  }

  /// Distance of a pair, or a lower bound of it that is above `enough`.
  double distance(const Pair& pair, double enough) const {
    const Item &a = data_.items[pair.a], &b = data_.items[pair.b];
    const Placed &pa = placed_[pair.a], &pb = placed_[pair.b];
    const double bound = (pa.centre - pb.centre).norm() - a.bounds.radius - b.bounds.radius;
    if (bound > enough) return bound;
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
  std::optional<PointPair> points(const Pair& pair) const {
    const Placed &a = placed_[pair.a], &b = placed_[pair.b];
    return fcl_nearest_points(*data_.items[pair.a].fcl, a.R, a.p, *data_.items[pair.b].fcl, b.R,
                              b.p);
  }

  double hand_to_contact = 0;

 private:
  static void place(const Item& item, const Matrix3d& R, const Vector3d& p, Placed& out) {
    out.R.noalias() = R * item.R;
    out.p = R * item.pose.position + p;
    out.centre = out.R * item.bounds.centre + out.p;
    if (!item.round) return;
    out.round_a = out.R * item.round->a + out.p;
    out.round_b = out.R * item.round->b + out.p;
  }

  /// Of a sphere or capsule.
  RoundSegment round_of(std::size_t i) const {
    return {placed_[i].round_a, placed_[i].round_b, data_.items[i].round->radius};
  }

  const CollisionScene::Data& data_;
  bool has_target_;
  InPlaceArray<Placed, kItemsInPlace> placed_;
};

Proximity proximity(const CollisionScene::Data& data, const Pair& pair, double distance) {
  return {data.items[pair.a].name, data.items[pair.b].name, distance};
}

/// The closest pair that may not touch and its distance; null: there is none.
std::pair<const Pair*, double> closest_pair(const CollisionScene::Data& data,
                                            const Instant& instant, bool with_hand_and_target) {
  const Pair* closest = nullptr;
  double least = kInfinity;
  for (const Pair& pair : data.pairs) {
    if (!instant.is_present(pair) || instant.may_touch(pair) ||
        (pair.is_hand_and_target && !with_hand_and_target)) {
      continue;
    }
    const double distance = instant.distance(pair, least);
    if (closest == nullptr || distance < least) {
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
  PairMotion(const CollisionScene::Data& data, const SceneTravel& travel) : travel_(travel) {
    const bool are_all_on_base = std::all_of(data.pairs.begin(), data.pairs.end(),
                                             [](const Pair& pair) { return !pair.levers.empty(); });
    if (are_all_on_base) return;
    in_inertial_.resize(data.items.size());
    for (std::size_t i = 0; i < data.items.size(); ++i) {
      in_inertial_[i] = motion_in_inertial(data.items[i], travel);
    }
  }

  double of(const Pair& pair) const {
    if (pair.levers.empty()) return in_inertial_[pair.a] + in_inertial_[pair.b];
    double motion = 0;
    for (std::size_t k = 0; k < pair.levers.size(); ++k) {
      motion += travel_.joints[static_cast<Eigen::Index>(k)] * pair.levers[k];
    }
    return motion;
  }

 private:
  const SceneTravel& travel_;
  InPlaceArray<double, kItemsInPlace> in_inertial_;  ///< of each item
};

}  // namespace

std::optional<Proximity> CollisionScene::first_hit(const Kinematics<double>& kinematics,
                                                   const Pose& base, const Pose* target,
                                                   double margin) const {
  const Instant instant(*data_, kinematics, base, target);
  for (const Pair& pair : data_->pairs) {
    if (!instant.is_present(pair) || instant.may_touch(pair)) continue;
    const double distance = instant.distance(pair, std::max(margin, 0.0));
    if (distance <= 0 || distance < margin) return proximity(*data_, pair, distance);
  }
  return std::nullopt;
}

std::optional<Proximity> CollisionScene::nearest(const Kinematics<double>& kinematics,
                                                 const Pose& base, const Pose* target,
                                                 bool with_hand_and_target) const {
  const Instant instant(*data_, kinematics, base, target);
  const auto [pair, distance] = closest_pair(*data_, instant, with_hand_and_target);
  if (pair == nullptr) return std::nullopt;
  return proximity(*data_, *pair, distance);
}

std::optional<NearestPoints> CollisionScene::nearest_points(const Kinematics<double>& kinematics,
                                                            const Pose& base, const Pose* target,
                                                            bool with_hand_and_target) const {
  const Instant instant(*data_, kinematics, base, target);
  const auto [pair, distance] = closest_pair(*data_, instant, with_hand_and_target);
  const auto points = pair == nullptr ? std::nullopt : instant.points(*pair);
  if (!points) return std::nullopt;
  return NearestPoints{proximity(*data_, *pair, distance), points->front(), points->back()};
}

SweepResult CollisionScene::sweep(const Kinematics<double>& kinematics, const Pose& base,
                                  const Pose* target, const SceneTravel& travel,
                                  double margin) const {
  const Instant instant(*data_, kinematics, base, target);
  const PairMotion motions(*data_, travel);
  SweepResult result;
  double smallest_reserve = 0;
  for (const Pair& pair : data_->pairs) {
    if (!instant.is_present(pair)) continue;
    const double motion = motions.of(pair);
    double reserve = kInfinity;  // how much more the pair could have moved
    double distance = 0;
    if (instant.may_touch(pair)) {
      // The hand may touch now; is that so during the whole interval?
      reserve = data_->contact_allowance - instant.hand_to_contact -
                (motion_with_base(data_->hand, travel) + travel.target_translation +
                 travel.target_rotation * data_->contact_point.norm());
      if (reserve >= 0) continue;
    }
    if (reserve == kInfinity) {
      distance = instant.distance(pair, margin + motion);
      if (distance <= 0 || distance < margin) {
        return {SweepVerdict::Hit, proximity(*data_, pair, distance)};
      }
      reserve = distance - margin - motion;
    }
    if (reserve < smallest_reserve) {
      smallest_reserve = reserve;
      result = {SweepVerdict::Unsure, proximity(*data_, pair, distance)};
    }
  }
  return result;
}

}  // namespace stillbase
