// Base motion without momentum, and joint torques with the base free or held, in wide registers.
#pragma once

#include "dynamics/wide_factor.hpp"
#include "dynamics/wide_posture.hpp"
#include "dynamics/wide_spatial.hpp"

namespace stillbase {

namespace {

/// The base's own equations.
struct WideFreeBase {
  WideWhole whole;
  WideNumber factor[9];  ///< of Htilde_omega

  [[gnu::always_inline]] explicit WideFreeBase(const WideArm& arm) : whole(arm.total) {
    const double* const entries = numbers(whole.Htilde_omega.c0);
    factorize_entries(
        cholesky_loops::Size<3>(), [entries](auto i, auto j) { return entries[i + 4 * j]; },
        factor);
  }
  /// The twist x of H_b x = momentum.
  [[gnu::always_inline]] WideSpatial twist(const WideSpatial& momentum) const {
    namespace loops = cholesky_loops;
    constexpr loops::Size<3> n;
    const V L_g = momentum.w - cross(whole.r_bg, momentum.v);
    WideNumber b[3] = {WideNumber(L_g[0]), WideNumber(L_g[1]), WideNumber(L_g[2])};
    loops::solve_scaled(factor, n, n, b);
    loops::solve_transposed(factor, n, n, b);
    const V omega = {b[0].x, b[1].x, b[2].x, 0};
    return {whole.base_velocity(momentum.v, omega), omega};
  }
};

/// Minus the momentum of joint rates, or of their accelerations: the base must carry it.
[[gnu::always_inline]] inline WideSpatial minus_momentum(int joints, const WideArm& arm,
                                                         const double* rates) {
  WideSpatial out{all(0), all(0)};
  for (int k = 0; k < joints; ++k) {
    out.v -= arm.p[k] * all(rates[k]);
    out.w -= arm.L[k] * all(rates[k]);
  }
  return out;
}

void wide_base_velocity(const RobotModel& robot, const WideJoints& at, const double* phidot,
                        double* Omega) {
  WidePose poses[kWideBodies];
  place_bodies(robot, at, poses);
  const WideArm arm(
      robot, [&poses](int k) -> const WidePose& { return poses[k]; }, [](int, const Wide3x3&) {});
  const auto n = static_cast<int>(robot.bodies.size());
  const WideSpatial twist = WideFreeBase(arm).twist(minus_momentum(n, arm, phidot));
  store3(Omega, twist.v);
  store3(Omega + 3, twist.w);
}

void wide_torques(const RobotModel& robot, const WideJoints& at, const WideJointMotion& motion,
                  bool base_moves, double* tau) {
  const Joint* const joints = &robot.joints[0];
  const Body* const bodies = &robot.bodies[0];
  const auto n = static_cast<int>(robot.bodies.size());
  const WidePosture posture(robot, at);
  const WideArm& arm = posture.arm;
  const WideSpatial none{all(0), all(0)};
  const WideFreeBase free(arm);
  const WideSpatial base = base_moves ? free.twist(minus_momentum(n, arm, motion.phidot)) : none;
  double Omega[6];
  store3(Omega, base.v);
  store3(Omega + 3, base.w);
  const WideBaseBias bias = posture.bias(robot, {Omega, motion.phidot}, tau);
  WideSpatial acceleration = none;  // of the base
  if (base_moves) {
    WideSpatial rest = minus_momentum(n, arm, motion.phiddot);
    rest.v -= bias.force;
    rest.w -= bias.moment;
    acceleration = free.twist(rest);
  }
  // H [dot Omega; phi''] as the momentum of these rates.
  WideSpatial twist[kWideBodies], momentum[kWideBodies];
  for (int k = 0; k < n; ++k) {
    const int parent = joints[k].parent;
    const WideSpatial& inherited = parent == kBase ? acceleration : twist[parent];
    twist[k] = {inherited.v + arm.v[k] * all(motion.phiddot[k]),
                inherited.w + arm.w[k] * all(motion.phiddot[k])};
    momentum[k] = momentum_of(twist[k], posture.poses[k].c, posture.inertias[k], bodies[k].mass);
  }
  for (int k = n - 1; k >= 0; --k) {
    const Joint& joint = joints[k];
    tau[k] += sum(arm.v[k] * momentum[k].v + arm.w[k] * momentum[k].w) +
              reflected(joint) * motion.phiddot[k];
    if (joint.parent != kBase) add(momentum[joint.parent], momentum[k]);
  }
}

}  // namespace

}  // namespace stillbase
