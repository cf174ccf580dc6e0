// The accelerations of the equation of motion (3) from joint positions and rates on in wide
// registers: poses, inertia, bias forces and factor are nowhere written down.
#pragma once

#include "dynamics/wide_equations.hpp"
#include "dynamics/wide_posture.hpp"

namespace stillbase {

namespace {

void wide_motion(const RobotModel& robot, const WideJoints& at, const double* added_inertia,
                 const KnownWideMotion& now, const WideLoad& load, const WideMotion& out) {
  const auto n = static_cast<int>(robot.bodies.size());
  const WidePosture posture(robot, at);
  const WideArm& arm = posture.arm;
  double c_phi[kWideBodies];
  const WideBaseBias bias = posture.bias(robot, now, c_phi);
  WideEquations equations(robot, arm, added_inertia);
  const V f = load3(load.F_b) - bias.force;
  const V v_g = f * all(equations.whole.inverse_mass);  // acceleration of the system centroid
  store3(equations.x, load3(load.F_b + 3) - bias.moment - cross(equations.whole.r_bg, f));
  for (int k = 0; k < n; ++k) {
    equations.x[3 + k] = load.tau[k] - c_phi[k] - sum(arm.p[k] * v_g);
  }
  equations.solve(n);
  equations.put_motion(n, arm, f, out);
}

}  // namespace

}  // namespace stillbase
