// Robots some of whose joints follow others.
#pragma once

#include <stillbase/core/random.hpp>
#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// The same tree with some joints following others, in any order: a follower may stand before its
/// master. At least one joint stays free.
inline RobotModel with_couplings(const RobotModel& open, Random& random) {
  const int bodies = open.n();
  std::vector<int> number(static_cast<std::size_t>(bodies), -1);  // of a free joint
  RobotModel robot = open;
  robot.coupled_tree = open.joints;
  robot.joints.clear();
  const int always_free = random.index(bodies);
  for (int k = 0; k < bodies; ++k) {
    if (k != always_free && random.uniform() < 0.5) continue;
    number[static_cast<std::size_t>(k)] = robot.n();
    robot.joints.push_back(open.joints[static_cast<std::size_t>(k)]);
  }
  for (int k = 0; k < bodies; ++k) {
    const int own = number[static_cast<std::size_t>(k)];
    if (own >= 0) {
      robot.couplings.push_back({own, 1, 0});
    } else {
      robot.couplings.push_back(
          {random.index(robot.n()), random.uniform(-2, 2), random.uniform(-0.5, 0.5)});
    }
  }
  return robot;
}

/// G of phi_b = G phi + g.
inline Eigen::MatrixXd coupling_matrix(const RobotModel& robot) {
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(robot.num_bodies(), robot.n());
  for (int k = 0; k < robot.num_bodies(); ++k) {
    const Coupling& coupling = robot.couplings[static_cast<std::size_t>(k)];
    G(k, coupling.joint) = coupling.ratio;
  }
  return G;
}

/// phi_b.
inline JointVectord body_positions(const RobotModel& robot, const JointVectord& phi) {
  JointVectord all(robot.num_bodies());
  for (int k = 0; k < robot.num_bodies(); ++k) {
    const Coupling& coupling = robot.couplings[static_cast<std::size_t>(k)];
    all[k] = coupling.ratio * phi[coupling.joint] + coupling.offset;
  }
  return all;
}

}  // namespace stillbase
