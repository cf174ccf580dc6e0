// Small robots for the tests of collision and approach, built without a file.
#pragma once

#include <string>

#include <stillbase/plan/problem.hpp>
#include <stillbase/robot/robot_model.hpp>

namespace stillbase::test {

inline Pose along_x(double x) {
  return {Vector3d(x, 0, 0),
          Eigen::Quaterniond(Eigen::AngleAxisd(1.5707963267948966, Vector3d::UnitY()))};
}

/// A chain of `links` capsules of 2 m turning about z, on a base box of 2.4 x 1 x 1 m. The paper's
/// robot in reading A for two links and shoulder_x = 1.4: the shoulder stands 0.2 m off the box.
inline RobotModel planar_robot(int links = 2, double shoulder_x = 1.4) {
  RobotModel robot;
  robot.name = "planar";
  robot.base.name = "base";
  robot.base.mass = 1000;
  robot.base.inertia = Vector3d(338, 338, 563.3).asDiagonal();
  robot.shapes.push_back({kBase, "base", Pose{}, Box{Vector3d(2.4, 1, 1)}});
  for (int k = 0; k < links; ++k) {
    Joint joint;
    joint.name = "joint" + std::to_string(k + 1);
    joint.parent = k - 1;
    joint.p = Vector3d(k == 0 ? shoulder_x : 2.0, 0, 0);
    joint.lower = -3.1;
    joint.upper = 3.1;
    joint.max_velocity = 0.5;
    robot.joints.push_back(joint);
    Body body;
    body.name = "link" + std::to_string(k + 1);
    body.mass = 100;
    body.centroid = Vector3d(1, 0, 0);
    body.inertia = Vector3d(0.333, 33.3, 33.3).asDiagonal();
    robot.bodies.push_back(body);
    robot.shapes.push_back({k, body.name, along_x(1), Capsule{0.08, 2.0}});
  }
  robot.hand = "hand";
  robot.hand_body = links - 1;
  robot.p_hand = Vector3d(2, 0, 0);
  robot.moves_hand.assign(static_cast<std::size_t>(links), true);
  return robot;
}

/// A round point mass of 100 kg as in the paper.
inline TargetBody point_target() {
  TargetBody body;
  body.name = "point_mass";
  body.mass = 100;
  body.is_point_mass = true;
  body.shapes.push_back({Pose{}, Sphere{0.1}});
  return body;
}

/// A cube of 0.6 m with an off-centre feature on its +x face.
inline TargetBody cube_target() {
  TargetBody body;
  body.name = "cube";
  body.mass = 50;
  body.inertia = 3.0 * Matrix3d::Identity();
  body.shapes.push_back({Pose{}, Box{Vector3d(0.6, 0.6, 0.6)}});
  body.features.push_back({"face", Vector3d(0.3, 0.12, 0.06), Vector3d::UnitX()});
  return body;
}

}  // namespace stillbase::test
