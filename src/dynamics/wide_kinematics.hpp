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
    // From the parent's axes to those of body k: off the chain of products along the arm.
    Wide3x3 turned = load3x3(numbers(joint.R));
    if (joint.type != JointType::Prismatic) {
      const V c = all(at.cosine[k]), s = all(at.sine[k]);
      turned = {turned.c0 * c + turned.c1 * s, turned.c1 * c - turned.c0 * s, turned.c2};
    }
    WidePose& pose = poses[k];
    if (joint.parent == kBase) {
      pose.R = turned;
      pose.o = load3(numbers(joint.p));
    } else {
      const WidePose& parent = poses[joint.parent];
      const double* const entries = numbers(turned.c0);
      pose.R = {times(parent.R, entries), times(parent.R, entries + 4),
                times(parent.R, entries + 8)};
      pose.o = parent.o + times(parent.R, numbers(joint.p));
    }
    if (joint.type == JointType::Prismatic) pose.o += pose.R.c2 * all(at.positions[k]);
    pose.c = pose.o + times(pose.R, numbers(bodies[k].centroid));
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
