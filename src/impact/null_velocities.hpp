// Joint velocities in the angular reaction null space, of many postures at once.
#pragma once

#include <vector>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// One posture per row.
struct NullVelocities {
  Eigen::MatrixXd phi;           ///< joint positions, count x n
  Eigen::MatrixXd wanted;        ///< velocities of the free joints, count x m
  Eigen::MatrixXd phidot;        ///< result, as `wanted`, see NullVelocity
  Eigen::VectorXd conditioning;  ///< result
};

/// nearest_null_velocity() of every row.
void find_null_velocities(const RobotModel& robot, const std::vector<Eigen::Index>& free,
                          NullVelocities& batch);

}  // namespace stillbase
