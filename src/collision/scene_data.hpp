// What a scene keeps: every shape with its motion bounds, and the pairs to look at.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <stillbase/collision/scene.hpp>

#include "collision/closed_forms.hpp"
#include "collision/fcl_shape.hpp"

namespace stillbase {

enum class Carrier { Robot, Target, FixedInBase, FixedInInertial };

/// One shape and what carries it.
struct SceneItem {
  Carrier carrier = Carrier::Robot;
  int body = kBase;  ///< Robot: body index
  std::string name;
  Pose pose;  ///< shape frame in the carrier's frame
  Matrix3d R = Matrix3d::Identity();
  BoundingSphere bounds;  ///< in the shape's frame
  bool is_round = false;
  RoundSegment round;  ///< in the shape's frame
  std::shared_ptr<const FclShape> fcl;
  double reach = 0;       ///< no point is further from the carrier's origin, m
  double base_reach = 0;  ///< Robot: no point is ever further from B's origin, m
  JointVectord lever;  ///< Robot: m of motion per rad (m) of each joint, 0 for joints off the way
};

struct ScenePair {
  std::size_t a = 0, b = 0;
  bool hand_and_target = false;
};

struct CollisionScene::Data {
  std::vector<SceneItem> items;
  std::vector<ScenePair> pairs;
  bool has_contact_point = false;
  Vector3d contact_point = Vector3d::Zero();  ///< in T
  double contact_radius = 0;                  ///< of the sphere met when there is no feature
  double contact_allowance = 0;
  double hand_base_reach = 0;
  JointVectord hand_lever;
};

}  // namespace stillbase
