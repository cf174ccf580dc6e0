// The paper's planar two-link robot, both readings of the mount, written down in code.
#pragma once

#include <Eigen/Geometry>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase::reference_test {

inline constexpr double kDegree = 3.14159265358979323846 / 180;

/// Table I of the paper. Out-of-plane inertias must not matter; `out_of_plane` scales them.
/// @param mount_y 0: reading A, 1.2: reading B
/// @param mass_scale scales all masses and inertias
inline RobotModel planar_two_link(double mount_y, double mass_scale = 1, double out_of_plane = 1) {
  RobotModel robot;
  robot.name = "planar_two_link";
  robot.base.name = "base";
  robot.base.mass = 1000 * mass_scale;
  robot.base.inertia =
      Vector3d(0.6 * 563.3 * out_of_plane, 0.6 * 563.3 * out_of_plane, 563.3).asDiagonal();
  robot.base.inertia *= mass_scale;
  for (int k = 0; k < 2; ++k) {
    Joint joint;
    joint.name = "joint" + std::to_string(k + 1);
    joint.type = JointType::Continuous;
    joint.parent = k - 1;
    joint.p = k == 0 ? Vector3d(1.4, mount_y, 0) : Vector3d(2, 0, 0);
    robot.joints.push_back(joint);
    Body body;
    body.name = "link" + std::to_string(k + 1);
    body.mass = 100 * mass_scale;
    body.centroid = Vector3d(1, 0, 0);
    body.inertia = Vector3d(0.333 * out_of_plane, 33.3, 33.3).asDiagonal();
    body.inertia *= mass_scale;
    robot.bodies.push_back(body);
  }
  robot.hand = "hand";
  robot.hand_body = 1;
  robot.p_hand = Vector3d(2, 0, 0);
  robot.moves_hand = {true, true};
  return robot;
}

}  // namespace stillbase::reference_test
