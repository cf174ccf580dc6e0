// What the equation of motion takes of a posture, in wide registers.
#pragma once

#include "dynamics/wide_bias.hpp"
#include "dynamics/wide_inertia.hpp"

namespace stillbase {

namespace {

struct WidePosture {
  WidePose poses[kWideBodies];
  Wide3x3 inertias[kWideBodies];  ///< of the bodies about their own centroids
  WideArm arm;

  [[gnu::always_inline]] WidePosture(const RobotModel& robot, const WideJoints& at)
      : arm(
            robot_placed(robot, at), [this](int k) -> const WidePose& { return poses[k]; },
            [this](int k, const Wide3x3& I) { inertias[k] = I; }) {}

  /// See sum_bias().
  [[gnu::always_inline]] WideBaseBias bias(const RobotModel& robot, const KnownWideMotion& motion,
                                           double* c_phi) const {
    return sum_bias(
        robot,
        [this](int k) -> WideBody {
          return {poses[k].R.c2, poses[k].o, poses[k].c, inertias[k]};
        },
        motion, c_phi);
  }

 private:
  /// The arm is made of the poses.
  [[gnu::always_inline]] const RobotModel& robot_placed(const RobotModel& robot,
                                                        const WideJoints& at) {
    place_bodies(robot, at, poses);
    return robot;
  }
};

}  // namespace

}  // namespace stillbase
