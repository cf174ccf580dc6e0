// The lines of kinematics_kernel.hpp in wide registers.
#pragma once

#include "dynamics/wide_vectors.hpp"

namespace stillbase {

namespace {

/// Axes, origin and centroid of a body in B.
struct WidePose {
  Wide3x3 R;
  V o, c;
};

[[gnu::always_inline]] inline void place_bodies(const RobotModel& robot, const WideJoints& at,
                                                WidePose* poses) {
  const Joint* const joints = &robot.tree()[0];
  const Body* const bodies = &robot.bodies[0];
  const auto n = static_cast<int>(robot.bodies.size());
  for (int k = 0; k < n; ++k) {
    const Joint& joint = joints[k];
    const double* const fixed = numbers(joint.R);
    Wide3x3 A;
    V o;
    if (joint.parent == kBase) {
      A = load3x3(fixed);
      o = load3(numbers(joint.p));
    } else {
      const WidePose& parent = poses[joint.parent];
      A = {times(parent.R, fixed), times(parent.R, fixed + 3), times(parent.R, fixed + 6)};
      o = parent.o + times(parent.R, numbers(joint.p));
    }
    if (joint.type == JointType::Prismatic) {
      o += A.c2 * all(at.positions[k]);
    } else {
      const V c = all(at.cosine[k]), s = all(at.sine[k]);
      A = {A.c0 * c + A.c1 * s, A.c1 * c - A.c0 * s, A.c2};
    }
    poses[k] = {A, o, o + times(A, numbers(bodies[k].centroid))};
  }
}

void wide_kinematics(const RobotModel& robot, const WideJoints& at, const WidePoses& out) {
  WidePose poses[kMaxJoints];
  place_bodies(robot, at, poses);
  const auto n = static_cast<int>(robot.bodies.size());
  for (int k = 0; k < n; ++k) {
    const bool next = k + 1 < n;
    store3x3(out.R + 9 * k, poses[k].R, next);
    store_row(out.o + 3 * k, poses[k].o, next);
    store_row(out.c + 3 * k, poses[k].c, next);
  }
}

}  // namespace

}  // namespace stillbase
