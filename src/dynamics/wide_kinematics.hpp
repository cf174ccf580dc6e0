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

/// Axes of a body that has them at zero in another order than its parent: without a product of
/// matrices.
[[gnu::always_inline]] inline Wide3x3 permuted_axes(const Wide3x3& parent, const ConstantAxes& R,
                                                    double sine, double cosine) {
  const V* const columns = &parent.c0;
  const double* const entries = numbers(R.matrix());
  const int i = R.row(0), j = R.row(1), k = R.row(2);
  const double x = entries[i], y = entries[3 + j], z = entries[6 + k];
  return {columns[i] * all(x * cosine) + columns[j] * all(y * sine),
          columns[j] * all(y * cosine) - columns[i] * all(x * sine), columns[k] * all(z)};
}

/// R p. Most origins of joints lie on an axis of the parent.
[[gnu::always_inline]] inline V times_origin(const Wide3x3& R, const double* p) {
  const bool x = p[0] != 0, y = p[1] != 0, z = p[2] != 0;
  if (x + y + z != 1) return times(R, p);
  const int along = y + 2 * z;
  return (&R.c0)[along] * all(p[along]);
}

[[gnu::always_inline]] inline void place_bodies(const RobotModel& robot, const WideJoints& at,
                                                WidePose* poses) {
  const Joint* const joints = &robot.tree()[0];
  const Body* const bodies = &robot.bodies[0];
  const auto n = static_cast<int>(robot.bodies.size());
  for (int k = 0; k < n; ++k) {
    const Joint& joint = joints[k];
    const bool is_on_base = joint.parent == kBase, rotates = joint.type != JointType::Prismatic;
    WidePose& pose = poses[k];
    if (!is_on_base && rotates && joint.R.are_permuted()) {
      pose.R = permuted_axes(poses[joint.parent].R, joint.R, at.sine[k], at.cosine[k]);
    } else {
      // From the parent's axes to those of body k: off the chain of products along the arm.
      Wide3x3 turned = load3x3(numbers(joint.R.matrix()));
      if (rotates) {
        const V c = all(at.cosine[k]), s = all(at.sine[k]);
        turned = {turned.c0 * c + turned.c1 * s, turned.c1 * c - turned.c0 * s, turned.c2};
      }
      pose.R = is_on_base ? turned : times(poses[joint.parent].R, turned);
    }
    if (is_on_base) {
      pose.o = load3(numbers(joint.p));
    } else {
      const WidePose& parent = poses[joint.parent];
      pose.o = parent.o + times_origin(parent.R, numbers(joint.p));
    }
    if (!rotates) pose.o += pose.R.c2 * all(at.positions[k]);
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
