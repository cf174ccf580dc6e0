// What a scene keeps: shapes, what carries them, and the pairs that are checked.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <stillbase/collision/scene.hpp>

#include "collision/closed_forms.hpp"
#include "collision/fcl_shape.hpp"

namespace stillbase {

enum class Carrier { Robot, Target, Inertial };

/// One shape and what carries it. An obstacle fixed in B is a shape of the base body.
struct SceneItem {
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

struct ScenePair {
  std::size_t a = 0, b = 0;
  bool is_target = false;  ///< a belongs to the target
  bool is_hand_and_target = false;
  bool is_on_base = false;  ///< the base carries both
};

struct CollisionScene::Data {
  std::vector<SceneItem> items;
  std::vector<ScenePair> pairs;
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

  void measure_levers();
  void measure_reach();
};

}  // namespace stillbase
