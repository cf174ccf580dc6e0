// Building a scene by the pair rules of scene.hpp.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/rotation.hpp>

#include "collision/scene_data.hpp"
#include "plan/allowed_contacts.hpp"

namespace stillbase {

void CollisionScene::Data::measure_levers() {
  levers.setZero(hand.lever.size(), static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!pairs[i].is_on_base) continue;
    const MotionBound &a = items[pairs[i].a].motion, &b = items[pairs[i].b].motion;
    for (Eigen::Index k = 0; k < levers.rows(); ++k) {
      if ((a.lever[k] > 0) == (b.lever[k] > 0)) continue;
      levers(k, static_cast<Eigen::Index>(i)) = std::max(a.lever[k], b.lever[k]);
    }
  }
}

void CollisionScene::Data::measure_reach() {
  most = hand;
  for (const SceneItem& item : items) {
    if (item.carrier == Carrier::Target) most_reach = std::max(most_reach, item.reach);
    if (item.carrier != Carrier::Robot) continue;
    most.lever = most.lever.cwiseMax(item.motion.lever);
    most.base_reach = std::max(most.base_reach, item.motion.base_reach);
  }
}

namespace {

SceneItem make_item(Carrier carrier, int body, const std::string& name, const Pose& pose,
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
    const Pose in_parent = Pose{joint.p, Eigen::Quaterniond(joint.R.matrix())} * moved * child.pose;
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
  std::vector<SceneItem>& items = data->items;
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
  for (SceneItem& item : items) {
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
  data->measure_levers();
  data->measure_reach();
  data_ = std::move(data);
}

CollisionScene::CollisionScene(const CaptureProblem& problem)
    : CollisionScene(problem.robot, parts_of(problem)) {}

CollisionScene CollisionScene::target_pairs_only() const {
  auto reduced = std::make_shared<Data>(*data_);
  std::erase_if(reduced->pairs, [](const ScenePair& pair) { return !pair.is_target; });
  reduced->measure_levers();
  CollisionScene scene(*this);
  scene.data_ = std::move(reduced);
  return scene;
}

int CollisionScene::pair_count() const { return static_cast<int>(data_->pairs.size()); }

std::vector<CollisionScene::ShapePair> CollisionScene::shape_pairs() const {
  std::vector<ShapePair> pairs;
  for (const ScenePair& pair : data_->pairs) pairs.push_back({pair.a, pair.b});
  return pairs;
}

}  // namespace stillbase
