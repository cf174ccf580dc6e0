// Asking a scene. Everything is expressed in B, so that self-collision does not see the base pose.
#include <stillbase/collision/scene.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "collision/scene_data.hpp"

namespace stillbase {

std::string to_string(const Proximity& proximity) {
  return proximity.first + " with " + proximity.second;
}

namespace {

/// A shape placed in B.
struct Placed {
  Matrix3d R;
  Vector3d p;
  Vector3d centre;  ///< of the bounding sphere
  RoundSegment round;
};

Placed place(const SceneItem& item, const Matrix3d& R, const Vector3d& p) {
  Placed placed;
  placed.R = R * item.R;
  placed.p = R * item.pose.position + p;
  placed.centre = placed.R * item.bounds.centre + placed.p;
  if (item.is_round) {
    placed.round = {placed.R * item.round.a + placed.p, placed.R * item.round.b + placed.p,
                    item.round.radius};
  }
  return placed;
}

/// All shapes in B at one instant, and the hand's distance from where it will touch.
struct Instant {
  std::vector<Placed> placed;
  bool target_present = false;
  double hand_to_contact = 0;
};

Instant place_all(const CollisionScene::Data& data, const Kinematics<double>& kinematics,
                  const Pose& base, const Pose* target) {
  const Pose T_BN = base.inverse();
  const Matrix3d R_BN = T_BN.orientation.toRotationMatrix();
  Instant instant;
  instant.target_present = target != nullptr;
  Matrix3d R_BT = Matrix3d::Identity();
  Vector3d p_BT = Vector3d::Zero();
  if (target != nullptr) {
    const Pose T_BT = T_BN * *target;
    R_BT = T_BT.orientation.toRotationMatrix();
    p_BT = T_BT.position;
    const Vector3d contact = R_BT * data.contact_point + p_BT;
    instant.hand_to_contact =
        std::max((kinematics.r_bh - contact).norm() - data.contact_radius, 0.0);
  }
  instant.placed.reserve(data.items.size());
  bool finite = std::isfinite(instant.hand_to_contact);
  for (const SceneItem& item : data.items) {
    switch (item.carrier) {
      case Carrier::Robot:
        if (item.body == kBase) {
          instant.placed.push_back(place(item, Matrix3d::Identity(), Vector3d::Zero()));
        } else {
          const auto k = static_cast<std::size_t>(item.body);
          instant.placed.push_back(place(item, kinematics.R[k], kinematics.o[k]));
        }
        break;
      case Carrier::Target:
        instant.placed.push_back(place(item, R_BT, p_BT));
        break;
      case Carrier::FixedInBase:
        instant.placed.push_back(place(item, Matrix3d::Identity(), Vector3d::Zero()));
        break;
      case Carrier::FixedInInertial:
        instant.placed.push_back(place(item, R_BN, T_BN.position));
        break;
    }
    finite = finite && instant.placed.back().R.allFinite() && instant.placed.back().p.allFinite();
  }
  // The gate before FCL, which would end the process.
  if (!finite) throw std::invalid_argument("collision query with a pose that is not finite");
  return instant;
}

/// Distance of a pair, or a lower bound of it that is above `enough`.
double pair_distance(const CollisionScene::Data& data, const Instant& instant,
                     const ScenePair& pair, double enough) {
  const SceneItem& a = data.items[pair.a];
  const SceneItem& b = data.items[pair.b];
  const Placed& pa = instant.placed[pair.a];
  const Placed& pb = instant.placed[pair.b];
  const double bound = (pa.centre - pb.centre).norm() - a.bounds.radius - b.bounds.radius;
  if (bound > enough) return bound;
  if (a.is_round && b.is_round) return round_distance(pa.round, pb.round);
  return fcl_distance(*a.fcl, pa.R, pa.p, *b.fcl, pb.R, pb.p);
}

bool is_target_pair(const CollisionScene::Data& data, const ScenePair& pair) {
  return data.items[pair.a].carrier == Carrier::Target;
}

/// The pair is not looked at now: no target there, or its hand may touch.
bool is_exempt(const CollisionScene::Data& data, const Instant& instant, const ScenePair& pair) {
  if (is_target_pair(data, pair) && !instant.target_present) return true;
  return pair.hand_and_target && data.has_contact_point &&
         instant.hand_to_contact <= data.contact_allowance;
}

Proximity proximity(const CollisionScene::Data& data, const ScenePair& pair, double distance) {
  return {data.items[pair.a].name, data.items[pair.b].name, distance};
}

double motion_in_base(const SceneItem& item, const SceneTravel& travel) {
  return item.carrier == Carrier::Robot ? item.lever.dot(travel.joints) : 0.0;
}

/// How far any point of the item moves in N.
double motion_in_inertial(const SceneItem& item, const SceneTravel& travel) {
  switch (item.carrier) {
    case Carrier::Robot:
      return motion_in_base(item, travel) + travel.base_translation +
             travel.base_rotation * item.base_reach;
    case Carrier::Target:
      return travel.target_translation + travel.target_rotation * item.reach;
    case Carrier::FixedInBase:
      return travel.base_translation + travel.base_rotation * item.reach;
    case Carrier::FixedInInertial:
      return 0;
  }
  return 0;
}

/// Bound on how much the distance of a pair can change.
double pair_motion(const CollisionScene::Data& data, const ScenePair& pair,
                   const SceneTravel& travel) {
  const SceneItem& a = data.items[pair.a];
  const SceneItem& b = data.items[pair.b];
  const auto rides_on_base = [](const SceneItem& item) {
    return item.carrier == Carrier::Robot || item.carrier == Carrier::FixedInBase;
  };
  if (!rides_on_base(a) || !rides_on_base(b)) {
    return motion_in_inertial(a, travel) + motion_in_inertial(b, travel);
  }
  if (a.carrier != Carrier::Robot || b.carrier != Carrier::Robot) {
    return motion_in_base(a, travel) + motion_in_base(b, travel);
  }
  // Joints that carry both do not move one against the other.
  double motion = 0;
  for (Eigen::Index k = 0; k < travel.joints.size(); ++k) {
    const bool carries_a = a.lever[k] > 0, carries_b = b.lever[k] > 0;
    if (carries_a != carries_b) motion += travel.joints[k] * (carries_a ? a.lever[k] : b.lever[k]);
  }
  return motion;
}

}  // namespace

std::optional<Proximity> CollisionScene::first_hit(const Kinematics<double>& kinematics,
                                                   const Pose& base, const Pose* target,
                                                   double margin) const {
  const Instant instant = place_all(*data_, kinematics, base, target);
  for (const ScenePair& pair : data_->pairs) {
    if (is_exempt(*data_, instant, pair)) continue;
    const double distance = pair_distance(*data_, instant, pair, std::max(margin, 0.0));
    if (distance <= 0 || distance < margin) return proximity(*data_, pair, distance);
  }
  return std::nullopt;
}

std::optional<Proximity> CollisionScene::nearest(const Kinematics<double>& kinematics,
                                                 const Pose& base, const Pose* target,
                                                 bool meeting) const {
  const Instant instant = place_all(*data_, kinematics, base, target);
  const ScenePair* closest = nullptr;
  double least = kInfinity;
  for (const ScenePair& pair : data_->pairs) {
    if (is_exempt(*data_, instant, pair) || (!meeting && pair.hand_and_target)) continue;
    const double distance = pair_distance(*data_, instant, pair, least);
    if (closest == nullptr || distance < least) {
      least = distance;
      closest = &pair;
    }
  }
  if (closest == nullptr) return std::nullopt;
  return proximity(*data_, *closest, least);
}

SweepResult CollisionScene::sweep(const Kinematics<double>& kinematics, const Pose& base,
                                  const Pose* target, const SceneTravel& travel,
                                  double margin) const {
  const Instant instant = place_all(*data_, kinematics, base, target);
  SweepResult result;
  double smallest_reserve = 0;
  for (const ScenePair& pair : data_->pairs) {
    if (is_target_pair(*data_, pair) && !instant.target_present) continue;
    const double motion = pair_motion(*data_, pair, travel);
    double reserve = kInfinity;  // how much more the pair could have moved
    double distance = 0;
    if (is_exempt(*data_, instant, pair)) {
      // The hand may touch now; is that so during the whole interval?
      const double hand_motion = data_->hand_lever.dot(travel.joints) + travel.base_translation +
                                 travel.base_rotation * data_->hand_base_reach +
                                 travel.target_translation +
                                 travel.target_rotation * data_->contact_point.norm();
      reserve = data_->contact_allowance - instant.hand_to_contact - hand_motion;
      if (reserve >= 0) continue;
    }
    if (reserve == kInfinity) {
      distance = pair_distance(*data_, instant, pair, margin + motion);
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
