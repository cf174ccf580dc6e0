// What the wide kernel takes of the joints.
#pragma once

#include "dynamics/kinematics_kernel.hpp"
#include "dynamics/wide_kernel.hpp"

namespace stillbase {

/// Of the joint of each body.
class WideJointValues {
 public:
  WideJointValues(const RobotModel& robot, const JointVectord& phi) : sines_(robot, phi) {
    for (int k = 0; k < robot.num_bodies(); ++k) {
      positions_[static_cast<std::size_t>(k)] = kernel::joint_position<double>(robot, phi, k);
    }
  }

  WideJoints plain() const { return {positions_.data(), sines_.sine.data(), sines_.cosine.data()}; }

 private:
  BodyWorkspace<double, double> positions_;
  kernel::JointSines sines_;
};

}  // namespace stillbase
