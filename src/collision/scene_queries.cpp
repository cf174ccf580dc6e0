// Asking a scene. Everything is expressed in B, so that self-collision does not see the base pose.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include <stillbase/core/constants.hpp>

#include "collision/scene_data.hpp"

namespace stillbase {

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
};

/// All shapes in B at one instant, and the hand's distance from where it will touch. Most pairs are
/// far apart by their bounding spheres and boxes: shapes are placed where a pair asks for them.
class Instant {
 public:
  Instant(const CollisionScene::Data& data, const Kinematics<double>& kinematics, const Pose& base,
          const Pose* target)
      : data_(data), kinematics_(kinematics), T_BN_(base.inverse()) {
    R_BN_ = T_BN_.orientation.toRotationMatrix();
    known_.resize(data.items.size());
    centres_.resize(data.items.size());
    placed_.resize(data.items.size());
    halves_.resize(data.items.size());
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
      if (data_.items[i].carrier == Carrier::Target) known_[i] = {};
    }
  }

  /// Whether the target is there, where the pair needs it.
  bool is_present(const ScenePair& pair) const { return has_target_ || !pair.is_target; }
  /// The pair may touch now.
  bool may_touch(const ScenePair& pair) const {
    return pair.is_hand_and_target && data_.has_contact_point &&
           hand_to_contact <= data_.contact_allowance;
  }

  /// By their bounding spheres a pair is further apart than `distance`.
  bool is_beyond(const ScenePair& pair, double distance) {
    const double reach =
        distance + data_.items[pair.a].bounds.radius + data_.items[pair.b].bounds.radius;
    return reach < 0 || (centre(pair.a) - centre(pair.b)).squaredNorm() > reach * reach;
  }

  /// By the box of one and the bounding sphere of the other a pair is further apart.
  bool is_beyond_boxes(const ScenePair& pair, double distance) {
    return is_beyond_box(pair.a, pair.b, distance) || is_beyond_box(pair.b, pair.a, distance);
  }

  /// Distance of a pair, or another number above `enough` when it is above.
  double distance(const ScenePair& pair, double enough) {
    if (is_beyond(pair, enough) || is_beyond_boxes(pair, enough)) return kInfinity;
    return distance_of_near(pair, enough);
  }

  /// Distance of a pair, or a lower bound of it that is above `enough`.
  double distance_of_near(const ScenePair& pair, double enough) {
    const SceneItem &a = data_.items[pair.a], &b = data_.items[pair.b];
    if (a.round && b.round) return round_distance(round_of(pair.a), round_of(pair.b));
    if (a.round && b.is_box) return round_box_distance(round_of(pair.a), box_of(pair.b));
    if (a.is_box && b.round) return round_box_distance(round_of(pair.b), box_of(pair.a));
    const Placed &pa = placed(pair.a), &pb = placed(pair.b);
    const double gap = box_gap({a.box.half, pa.R, pa.R * a.box.centre + pa.p},
                               {b.box.half, pb.R, pb.R * b.box.centre + pb.p});
    if (gap > enough + kFclError) return gap;
    if (a.is_box && b.is_box) {
      const double widest = widest_gap(box_of(pair.a), box_of(pair.b));
      if (widest > enough + kFclError) return widest;
    }
    return fcl_distance(*a.fcl, pa.R, pa.p, *b.fcl, pb.R, pb.p);
  }

  /// The closest points of a pair, in B.
  std::optional<PointPair> points(const ScenePair& pair) {
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

  /// Of the bounding sphere.
  const Vector3d& centre(std::size_t i) {
    if (!known_[i].centre) put_centre(i);
    return centres_[i];
  }
  void put_centre(std::size_t i) {
    known_[i].centre = true;
    const SceneItem& item = data_.items[i];
    with_carrier(item, [&](const Matrix3d& R, const Vector3d& p) {
      centres_[i] = R * item.bounds.centre + p;
    });
    require_finite(std::isfinite(centres_[i].sum()));
  }

  /// Calls take(R, p) with the pose of what carries the item, in B.
  template <class Take>
  void with_carrier(const SceneItem& item, Take take) const {
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
    if (known_[i].placed) return out;
    known_[i].placed = true;
    const SceneItem& item = data_.items[i];
    with_carrier(item, [&](const Matrix3d& R, const Vector3d& p) {
      out.R.noalias() = R * item.R;
      out.p = R * item.pose.position + p;
    });
    return out;
  }

  /// Of a sphere or capsule: its segment lies along z, its middle at the bounding sphere's centre.
  RoundSegment round_of(std::size_t i) {
    const SceneItem& item = data_.items[i];
    Vector3d& half = halves_[i];
    if (!known_[i].half) {
      known_[i].half = true;
      with_carrier(item, [&](const Matrix3d& R, const Vector3d&) {
        half = (R * item.R.col(2)) * item.round->b.z();
      });
    }
    return {centre(i) - half, centre(i) + half, item.round->radius};
  }

  /// Of a box.
  PlacedBox box_of(std::size_t i) {
    const Placed& at = placed(i);
    return {data_.items[i].box.half, at.R, at.p};
  }

  /// The bounding sphere of one shape is further than `distance` from another shape's box.
  bool is_beyond_box(std::size_t sphere, std::size_t box, double distance) {
    const SceneItem& item = data_.items[box];
    if (item.round) return false;  // its sphere or capsule is as fast
    const double reach = distance + data_.items[sphere].bounds.radius + kFclError;
    const Placed& at = placed(box);
    const Vector3d apart = at.R.transpose() * (centre(sphere) - at.p) - item.box.centre;
    return reach >= 0 &&
           (apart.cwiseAbs() - item.box.half).cwiseMax(0).squaredNorm() > reach * reach;
  }

  const CollisionScene::Data& data_;
  const Kinematics<double>& kinematics_;
  bool has_target_ = false;
  Pose T_BN_;
  Matrix3d R_BN_, R_BT_;
  Vector3d p_BT_;
  /// What has been worked out of a shape.
  struct Known {
    bool centre = false, placed = false, half = false;
  };
  InPlaceArray<Known, kItemsInPlace> known_;
  InPlaceArray<Vector3d, kItemsInPlace> centres_;  ///< of the bounding spheres
  InPlaceArray<Placed, kItemsInPlace> placed_;
  InPlaceArray<Vector3d, kItemsInPlace> halves_;  ///< of the segments of spheres and capsules
};

Proximity proximity(const CollisionScene::Data& data, const ScenePair& pair, double distance) {
  return {data.items[pair.a].name, data.items[pair.b].name, distance};
}

/// The closest pair that may not touch and its distance; null: there is none.
std::pair<const ScenePair*, double> closest_pair(const CollisionScene::Data& data, Instant& instant,
                                                 bool with_hand_and_target,
                                                 double least = kInfinity) {
  const ScenePair* closest = nullptr;
  for (const ScenePair& pair : data.pairs) {
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
double motion_in_inertial(const SceneItem& item, const SceneTravel& travel) {
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
        most_(motion_with_base(data.most, travel) + travel.target_translation +
              travel.target_rotation * data.most_reach) {}

  /// Of any pair: the base carries one of its shapes at most, or both as in Data::levers.
  double most() const { return most_; }
  /// Of the pair with that number.
  double of(std::size_t i) const {
    const ScenePair& pair = data_.pairs[i];
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
                        const PairMotion& motions, const SceneTravel& travel, double margin,
                        const std::vector<std::size_t>* among) {
  const double least = std::max(margin, 0.0);  // bodies that overlap are a hit in any case
  SweepResult result;
  double smallest_reserve = 0;
  const std::size_t count = among == nullptr ? data.pairs.size() : among->size();
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = among == nullptr ? k : (*among)[k];
    const ScenePair& pair = data.pairs[i];
    if (!instant.is_present(pair)) continue;
    const bool may_touch = instant.may_touch(pair);
    if (!may_touch && instant.is_beyond(pair, least + motions.most())) continue;
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
      if (instant.is_beyond(pair, least + motion) ||
          instant.is_beyond_boxes(pair, least + motion)) {
        continue;
      }
      // A bound will do: what it leaves unsure is looked at again, with less motion.
      distance = instant.distance_of_near(pair, least);
      if (distance <= 0 || distance < margin) {
        return {SweepVerdict::Hit, proximity(data, pair, distance)};
      }
      reserve = distance - margin - motion;
    }
    if (reserve >= 0) continue;
    result.verdict = SweepVerdict::Unsure;
    result.unsure.push_back(i);
    if (reserve < smallest_reserve) {
      smallest_reserve = reserve;
      result.closest = proximity(data, pair, distance);
    }
  }
  return result;
}

/// See CollisionScene::first_hit().
/// @param with_target_alone only pairs that it is part of
std::optional<Proximity> first_pair(const CollisionScene::Data& data, Instant& instant,
                                    bool with_target_alone, double margin) {
  for (const ScenePair& pair : data.pairs) {
    if (with_target_alone && !pair.is_target) continue;
    if (!instant.is_present(pair) || instant.may_touch(pair)) continue;
    const double distance = instant.distance(pair, std::max(margin, 0.0));
    if (distance <= 0 || distance < margin) return proximity(data, pair, distance);
  }
  return std::nullopt;
}

}  // namespace

std::optional<Proximity> CollisionScene::first_hit(const Kinematics<double>& kinematics,
                                                   const Pose& base, const Pose* target,
                                                   double margin) const {
  Instant instant(*data_, kinematics, base, target);
  return first_pair(*data_, instant, false, margin);
}

std::optional<Proximity> CollisionScene::first_hit_of_each(const Kinematics<double>& kinematics,
                                                           const Pose& base, int count,
                                                           const std::function<Pose(int)>& target,
                                                           double margin) const {
  Instant instant(*data_, kinematics, base, nullptr);
  for (int i = 0; i < count; ++i) {
    instant.put_target(target(i));
    if (auto hit = first_pair(*data_, instant, i > 0, margin)) return hit;
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
                                  const Pose* target, const SceneTravel& travel, double margin,
                                  const std::vector<std::size_t>* among) const {
  Instant instant(*data_, kinematics, base, target);
  return sweep_pairs(*data_, instant, PairMotion(*data_, travel), travel, margin, among);
}

SweepResult CollisionScene::sweep_each(const Kinematics<double>& kinematics, const Pose& base,
                                       const std::vector<Pose>& targets, const SceneTravel& travel,
                                       double margin, const std::vector<std::size_t>* among) const {
  Instant instant(*data_, kinematics, base, nullptr);
  const PairMotion motions(*data_, travel);
  SweepResult out;
  for (const Pose& target : targets) {
    instant.put_target(target);
    SweepResult here = sweep_pairs(*data_, instant, motions, travel, margin, among);
    if (here.verdict == SweepVerdict::Hit) return here;
    if (here.verdict == SweepVerdict::Clear) continue;
    if (out.verdict == SweepVerdict::Unsure) {
      std::vector<std::size_t> both;
      std::set_union(out.unsure.begin(), out.unsure.end(), here.unsure.begin(), here.unsure.end(),
                     std::back_inserter(both));
      here.unsure = std::move(both);
    }
    out = std::move(here);
  }
  return out;
}

}  // namespace stillbase
