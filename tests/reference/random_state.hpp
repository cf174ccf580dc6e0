// Random robots and states for tests that must not depend on other rooms.
#pragma once

#include <Eigen/Dense>

#include <stillbase/core/random.hpp>
#include <stillbase/reference/reference.hpp>

namespace stillbase::reference_test {

inline Matrix3d random_rotation(Random& random) {
  return Eigen::AngleAxisd(random.uniform(0, 3.1), random.unit_vector()).toRotationMatrix();
}

inline Vector3d random_vector(Random& random, double scale) {
  // One after the other: compilers evaluate arguments in different orders.
  const double z = random.normal(), y = random.normal(), x = random.normal();
  return scale * Vector3d(x, y, z);
}

/// A body of point masses spread at random: its inertia is physical by construction.
inline Body random_body(Random& random, const std::string& name) {
  Body body;
  body.name = name;
  std::vector<std::pair<double, Vector3d>> points;
  for (int i = 0; i < 6; ++i) {
    points.emplace_back(random.uniform(0.2, 5), random_vector(random, 0.3));
    body.mass += points.back().first;
    body.centroid += points.back().first * points.back().second;
  }
  body.centroid /= body.mass;
  for (const auto& [mass, point] : points) {
    const Vector3d r = point - body.centroid;
    body.inertia += mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
  }
  return body;
}

inline RobotModel random_robot(Random& random, int joints, bool tree) {
  RobotModel robot;
  robot.name = "random";
  robot.base = random_body(random, "base");
  robot.base.mass *= 3;
  robot.base.inertia *= 3;
  robot.base.centroid.setZero();
  for (int k = 0; k < joints; ++k) {
    Joint joint;
    joint.name = "joint" + std::to_string(k);
    joint.type = random.uniform() < 0.25 ? JointType::Prismatic : JointType::Revolute;
    joint.parent = tree ? random.index(k + 1) - 1 : k - 1;
    joint.R = random_rotation(random);
    joint.p = random_vector(random, 0.4);
    robot.joints.push_back(joint);
    robot.bodies.push_back(random_body(random, "body" + std::to_string(k)));
  }
  robot.hand = "hand";
  robot.hand_body = tree ? random.index(joints) : joints - 1;
  robot.R_hand = random_rotation(random);
  robot.p_hand = random_vector(random, 0.3);
  robot.moves_hand.assign(static_cast<std::size_t>(joints), false);
  for (int k = robot.hand_body; k != kBase; k = robot.joints[static_cast<std::size_t>(k)].parent)
    robot.moves_hand[static_cast<std::size_t>(k)] = true;
  return robot;
}

inline reference::State random_state(Random& random, int n) {
  reference::State state;
  state.phi.resize(n);
  state.phidot.resize(n);
  for (int k = 0; k < n; ++k) {
    state.phi(k) = random.uniform(-3, 3);
    state.phidot(k) = random.normal();
  }
  state.Omega << random_vector(random, 0.5), random_vector(random, 0.5);
  return state;
}

}  // namespace stillbase::reference_test
