// Ways in which the joints may resist, for the same impact side by side.
#pragma once

#include <vector>

#include <stillbase/impact/joint_resistance.hpp>
#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// A joint resistance to compare.
struct ComparedResistance {
  JointResistance resistance;
  /// The values are not the problem's: only there to show how large the effect can be.
  bool is_illustrative = false;
};

/// Free, rotor inertia, servo and all joints locked, in this order. The stated resistance takes its
/// model's place; stated rotor inertia or servo values are kept even when the model is another one
/// (sizes n). What is not stated is illustrative, on the scale of the joint's own inertia Hhat_kk
/// at the posture: a rotor inertia of Hhat_kk; a servo that would hold the joint alone critically
/// damped at 10 Hz, over a contact of 10 ms. Locked joints of the stated resistance stay the stated
/// ones.
std::vector<ComparedResistance> resistances_to_compare(const RobotModel& robot,
                                                       const JointVectord& phi,
                                                       const JointResistance& stated);

}  // namespace stillbase
