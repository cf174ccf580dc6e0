// Building a scene: shapes, motion bounds and the pair rules of scene.hpp.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <stillbase/core/constants.hpp>

#include "collision/scene_data.hpp"

namespace stillbase {

namespace {

/// Shapes that come this close to a joint's origin count as reaching it, m.
constexpr double kReachesJoint = 1e-6;

/// Bound on the stroke of a prismatic joint without limits, m: only motion bounds use it, and a
/// large one merely makes the sweep look more closely.
constexpr double kUnlimitedStroke = 1e3;

double stroke(const Joint& joint) {
  if (!joint.is_prismatic()) return 0;
  return std::min(std::max(std::abs(joint.lower), std::abs(joint.upper)), kUnlimitedStroke);
}

/// Levers of a point on `body` at most `reach` from its origin: how far it moves in B per unit of
/// each joint, and how far from B's origin it can be. Triangle inequality along the chain.
void bound_motion(const RobotModel& robot, int body, double reach, JointVectord& lever,
                  double& base_reach) {
  lever = JointVectord::Zero(robot.n());
  for (int k = body; k != kBase;) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    lever[k] = joint.is_prismatic() ? 1.0 : reach;
    reach += stroke(joint) + joint.p.norm();
    k = joint.parent;
  }
  base_reach = reach;
}

SceneItem make_item(Carrier carrier, int body, const std::string& name, const Pose& pose,
                    const Geometry& geometry) {
  if (!pose.is_finite() || !is_valid(geometry)) {
    throw std::invalid_argument("collision shape of " + name +
                                ": pose and sizes must be finite, sizes positive");
  }
  SceneItem item;
  item.carrier = carrier;
  item.body = body;
  item.name = name;
  item.pose = pose;
  item.R = pose.orientation.toRotationMatrix();
  item.bounds = bounding_sphere(geometry);
  item.is_round = as_round_segment(geometry, item.round);
  item.fcl = make_fcl_shape(geometry);
  item.reach = (pose * item.bounds.centre).norm() + item.bounds.radius;
  return item;
}

/// The shapes of a joint's child and parent overlap wherever the joint stands (looked at in 64
/// positions of its range): nothing that a path could avoid.
bool overlap_always(const Joint& joint, const CollisionShape& child, const CollisionShape& parent) {
  constexpr int kPositions = 64;
  const double low = std::isfinite(joint.lower) ? joint.lower : -kPi;
  const double high = std::isfinite(joint.upper) ? joint.upper : kPi;
  const auto child_fcl = make_fcl_shape(child.geometry),
             parent_fcl = make_fcl_shape(parent.geometry);
  for (int i = 0; i < kPositions; ++i) {
    const double phi = low + (high - low) * i / (kPositions - 1);
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
bool overlap_at_joint(const RobotModel& robot, const CollisionShape& a, const CollisionShape& b) {
  const CollisionShape& child = a.body > b.body ? a : b;
  const CollisionShape& parent = a.body > b.body ? b : a;
  if (child.body == kBase) return false;
  const Joint& joint = robot.joints[static_cast<std::size_t>(child.body)];
  if (joint.parent != parent.body) return false;
  const bool both_reach =
      point_distance(child.geometry, child.pose.inverse() * Vector3d(Vector3d::Zero())) <=
          kReachesJoint &&
      point_distance(parent.geometry, parent.pose.inverse() * joint.p) <= kReachesJoint;
  return both_reach || overlap_always(joint, child, parent);
}

bool is_allowed(const SceneParts& parts, const std::string& a, const std::string& b) {
  return std::any_of(
      parts.allowed_contacts.begin(), parts.allowed_contacts.end(), [&](const auto& pair) {
        return (pair.first == a && pair.second == b) || (pair.first == b && pair.second == a);
      });
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

CollisionScene::CollisionScene(const RobotModel& robot, const SceneParts& parts) {
  auto data = std::make_shared<Data>();
  std::vector<SceneItem>& items = data->items;

  for (const CollisionShape& shape : robot.shapes) {
    SceneItem item = make_item(Carrier::Robot, shape.body, shape.link, shape.pose, shape.geometry);
    bound_motion(robot, shape.body, item.reach, item.lever, item.base_reach);
    items.push_back(item);
  }
  const std::size_t robot_count = items.size();
  for (const Obstacle& obstacle : parts.obstacles) {
    items.push_back(
        make_item(obstacle.frame == Frame::Base ? Carrier::FixedInBase : Carrier::FixedInInertial,
                  kBase, obstacle.name, obstacle.pose, obstacle.geometry));
  }
  const std::size_t target_begin = items.size();
  if (parts.target) {
    for (const TargetShape& shape : parts.target->shapes) {
      items.push_back(make_item(Carrier::Target, kBase, kTargetName, shape.pose, shape.geometry));
    }
  }

  const auto add = [&](std::size_t a, std::size_t b, bool hand_and_target) {
    if (!is_allowed(parts, items[a].name, items[b].name)) {
      data->pairs.push_back({a, b, hand_and_target});
    }
  };
  for (std::size_t i = 0; i < robot_count; ++i) {
    for (std::size_t j = i + 1; j < robot_count; ++j) {
      if (items[i].body == items[j].body ||
          overlap_at_joint(robot, robot.shapes[i], robot.shapes[j])) {
        continue;
      }
      const bool i_outer = items[i].body > items[j].body;
      add(i_outer ? i : j, i_outer ? j : i, false);
    }
    for (std::size_t j = robot_count; j < target_begin; ++j) {
      if (items[i].body != kBase || items[j].carrier != Carrier::FixedInBase) add(i, j, false);
    }
  }
  for (std::size_t t = target_begin; t < items.size(); ++t) {
    for (std::size_t i = 0; i < target_begin; ++i) {
      if (items[i].carrier == Carrier::FixedInInertial) continue;
      add(t, i, items[i].carrier == Carrier::Robot && items[i].body == robot.hand_body);
    }
  }

  data->contact_allowance = parts.contact_allowance;
  if (parts.feature) {
    data->has_contact_point = true;
    data->contact_point = parts.feature->point;
  } else if (parts.target && !parts.target->shapes.empty()) {
    data->has_contact_point = true;
    double radius = 0;
    for (std::size_t t = target_begin; t < items.size(); ++t) {
      radius = std::max(radius, items[t].reach);
    }
    data->contact_radius = radius;
  }
  if (!data->contact_point.allFinite() || !(data->contact_allowance >= 0)) {
    throw std::invalid_argument("contact feature and allowance must be finite");
  }
  bound_motion(robot, robot.hand_body, robot.p_hand.norm(), data->hand_lever,
               data->hand_base_reach);
  data_ = std::move(data);
}

CollisionScene::CollisionScene(const CaptureProblem& problem)
    : CollisionScene(problem.robot, parts_of(problem)) {}

CollisionScene::CollisionScene(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

CollisionScene CollisionScene::target_pairs_only() const {
  auto reduced = std::make_shared<Data>(*data_);
  const auto without_target = [&](const ScenePair& pair) {
    return reduced->items[pair.a].carrier != Carrier::Target;
  };
  reduced->pairs.erase(std::remove_if(reduced->pairs.begin(), reduced->pairs.end(), without_target),
                       reduced->pairs.end());
  return CollisionScene(std::shared_ptr<const Data>(std::move(reduced)));
}

int CollisionScene::pair_count() const { return static_cast<int>(data_->pairs.size()); }

}  // namespace stillbase
