// compute_jump() from joint positions on in wide registers: poses, inertia and factor are nowhere
// written down.
#pragma once

#include "dynamics/wide_equations.hpp"

namespace stillbase {

namespace {

void wide_jump(const RobotModel& robot, const WideJoints& at, const double* added_inertia,
               const double* F, const WideMotion& out) {
  const Joint* const joints = &robot.joints[0];
  const auto n = static_cast<int>(robot.bodies.size());
  WidePose poses[kWideBodies];
  place_bodies(robot, at, poses);
  const WideArm arm(
      robot, [&poses](int k) -> const WidePose& { return poses[k]; }, [](int, const Wide3x3&) {});
  V r_bh = load3(numbers(robot.p_hand));
  if (robot.hand_body != kBase) {
    const WidePose& pose = poses[robot.hand_body];
    r_bh = pose.o + times(pose.R, numbers(robot.p_hand));
  }
  WideEquations equations(robot, arm, added_inertia);
  const V f = load3(F), moment = load3(F + 3) + cross(r_bh, f);  // about the base centroid
  const V v_g = f * all(equations.whole.inverse_mass);           // of the system centroid
  store3(equations.x, moment - cross(equations.whole.r_bg, f));
  bool moves_hand[kWideBodies] = {};  // as the robot's list, whose functions are not for this file
  for (int k = robot.hand_body; k != kBase; k = joints[k].parent) moves_hand[k] = true;
  for (int k = 0; k < n; ++k) {
    V power = -arm.p[k] * v_g;
    if (moves_hand[k]) power += arm.v[k] * f + arm.w[k] * moment;
    equations.x[3 + k] = sum(power);
  }
  equations.solve(n);
  equations.put_motion(n, arm, f, out);
}

}  // namespace

}  // namespace stillbase
