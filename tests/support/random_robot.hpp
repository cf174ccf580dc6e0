// Random robots for tests: physically possible, from one seeded generator.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <stillbase/core/random.hpp>
#include <stillbase/core/rotation.hpp>
#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// A uniformly distributed rotation.
inline Matrix3d random_rotation(Random& random) {
  Eigen::Vector4d q;
  for (int i = 0; i < 4; ++i) q[i] = random.normal();
  q.normalize();
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

/// Inertia tensor of a body of this mass and about this size (m) with random principal axes: each
/// principal moment is the sum of two second moments of mass, so the triangle inequality holds.
inline Matrix3d random_inertia(Random& random, double mass, double size) {
  Vector3d second_moments;
  for (int i = 0; i < 3; ++i) second_moments[i] = mass * size * size * random.uniform(0.02, 0.2);
  const Matrix3d R = random_rotation(random);
  const Vector3d moments = Vector3d::Constant(second_moments.sum()) - second_moments;
  const Matrix3d I = R * moments.asDiagonal() * R.transpose();
  return 0.5 * (I + I.transpose());
}

inline Vector3d random_vector(Random& random, double lower, double upper) {
  const double length = random.uniform(lower, upper);
  return length * random.unit_vector();
}

/// Parent of joint k such that the joints stay in depth-first order: the joint before it, or one
/// of that one's ancestors.
inline int random_parent(Random& random, const std::vector<Joint>& joints) {
  int parent = static_cast<int>(joints.size()) - 1;
  while (parent != kBase && random.uniform() < 0.35) parent = joints[parent].parent;
  return parent;
}

/// Fills the link list (base, link_1 .. link_n, hand) and puts the hand on the body.
inline RobotModel with_links_and_hand(RobotModel robot, int hand_body, const Pose& hand) {
  robot.base.name = "base";
  robot.links.push_back({"base", kBase, Pose{}, ""});
  for (int k = 0; k < robot.n(); ++k) {
    robot.joints[k].name = std::string("joint_").append(std::to_string(k + 1));
    robot.bodies[k].name = std::string("link_").append(std::to_string(k + 1));
    const int parent = robot.joints[k].parent;
    const std::string parent_name =
        parent == kBase ? std::string("base") : robot.bodies[parent].name;
    robot.links.push_back({robot.bodies[k].name, k, Pose{}, parent_name});
  }
  const std::string hand_parent =
      hand_body == kBase ? std::string("base") : robot.bodies[hand_body].name;
  robot.links.push_back({"hand", hand_body, hand, hand_parent});
  return with_hand(std::move(robot), "hand");
}

/// A robot with revolute and some prismatic joints, general joint frames and full inertia tensors.
/// @param joints n >= 1
/// @param tree false: a chain; true: random parents, joints in depth-first order
/// The hand is on a random leaf.
inline RobotModel random_robot(Random& random, int joints, bool tree) {
  RobotModel robot;
  robot.name = "random";
  robot.base.mass = random.uniform(20, 200);
  robot.base.inertia = random_inertia(random, robot.base.mass, 1.0);
  for (int k = 0; k < joints; ++k) {
    Joint joint;
    const double kind = random.uniform();
    joint.type = kind < 0.2   ? JointType::Prismatic
                 : kind < 0.4 ? JointType::Continuous
                              : JointType::Revolute;
    joint.parent = tree ? random_parent(random, robot.joints) : k - 1;
    joint.R = random_rotation(random);
    joint.p = random_vector(random, 0.2, 1.0);
    if (joint.type != JointType::Continuous) {
      const double range = joint.is_prismatic() ? 0.5 : 3.0;
      joint.lower = -random.uniform(0.3 * range, range);
      joint.upper = random.uniform(0.3 * range, range);
    }
    joint.max_velocity = random.uniform(0.5, 3);
    joint.max_effort = random.uniform(10, 200);
    robot.joints.push_back(joint);

    Body body;
    body.mass = random.uniform(1, 20);
    body.centroid = random_vector(random, 0, 0.5);
    body.inertia = random_inertia(random, body.mass, 0.5);
    robot.bodies.push_back(body);
  }
  std::vector<bool> is_leaf(robot.joints.size(), true);
  for (const Joint& joint : robot.joints) {
    if (joint.parent != kBase) is_leaf[joint.parent] = false;
  }
  int hand_body = random.index(joints);
  while (!is_leaf[hand_body]) hand_body = (hand_body + 1) % joints;
  const Pose hand{random_vector(random, 0.1, 0.6), Eigen::Quaterniond(random_rotation(random))};
  return with_links_and_hand(std::move(robot), hand_body, hand);
}

/// A chain of revolute joints about z; base centroid, joints, centroids and hand lie in the xy
/// plane, and z is a principal axis of every body: it moves in the plane when it starts there.
inline RobotModel random_planar_robot(Random& random, int links) {
  RobotModel robot;
  robot.name = "random_planar";
  const auto planar_inertia = [&](double mass, double size) {
    const double a = mass * size * size * random.uniform(0.02, 0.2);
    const double b = mass * size * size * random.uniform(0.02, 0.2);
    const double c = mass * size * size * random.uniform(0.02, 0.2);
    return Matrix3d(Vector3d(b + c, a + c, a + b).asDiagonal());
  };
  const auto planar_vector = [&](double lower, double upper) {
    const double length = random.uniform(lower, upper), angle = random.uniform(-3.2, 3.2);
    return Vector3d(length * std::cos(angle), length * std::sin(angle), 0);
  };
  robot.base.mass = random.uniform(50, 500);
  robot.base.inertia = planar_inertia(robot.base.mass, 1.0);
  for (int k = 0; k < links; ++k) {
    Joint joint;
    joint.type = JointType::Continuous;
    joint.parent = k - 1;
    joint.R = rotation_rpy(0, 0, random.uniform(-3, 3)).toRotationMatrix();
    joint.p = planar_vector(0.3, 1.5);
    joint.max_velocity = random.uniform(0.5, 3);
    joint.max_effort = random.uniform(10, 200);
    robot.joints.push_back(joint);

    Body body;
    body.mass = random.uniform(5, 50);
    body.centroid = planar_vector(0, 0.8);
    body.inertia = planar_inertia(body.mass, 1.0);
    robot.bodies.push_back(body);
  }
  const Pose hand{planar_vector(0.3, 1.0), rotation_rpy(0, 0, random.uniform(-3, 3))};
  return with_links_and_hand(std::move(robot), links - 1, hand);
}

}  // namespace stillbase
