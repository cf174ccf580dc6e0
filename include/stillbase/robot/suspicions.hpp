// What is possible in a robot file and yet most likely a mistake or a placeholder.
//
// Nothing here refuses a robot: a physical model may look odd. The size of a body is taken from its
// joints, its hand and its collision shapes, so a robot without shapes is judged by its joints
// alone.
#pragma once

#include <string>
#include <vector>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// One remark per finding, in words, in the order base, bodies, joints, robot.
///
/// Looked for: centroids at the joint of a body that reaches away from it; tensors that are the
/// same about every axis on a long body, that are a power of ten, that belong to a body of another
/// size, or that bodies of different mass or size share; joints without a bound on rate or effort,
/// with one of zero or an absurd one; masses out of proportion; bodies without collision shape;
/// joint axes that are all parallel.
std::vector<std::string> robot_suspicions(const RobotModel& robot);

}  // namespace stillbase
