// A robot on whose base nothing acts, in wide registers: its base's motion for one of the joints,
// and the torques of that.
#pragma once

#include "dynamics/wide_bias.hpp"
#include "dynamics/wide_factor.hpp"
#include "dynamics/wide_gradient.hpp"
#include "dynamics/wide_inertia.hpp"

namespace stillbase {

namespace {

/// The base twist x of H_b x = momentum.
[[gnu::always_inline]] inline WideSpatial base_twist(const WideArm& arm,
                                                     const WideSpatial& momentum) {
  const double mass = arm.total.h[3], inverse_mass = 1 / mass;
  const V r_bg = arm.total.h * all(inverse_mass);
  const Wide3x3 of_mass = point_mass(mass, r_bg).I;
  const Wide3x3& I = arm.total.I;
  const Wide3x3 Htilde_omega = {I.c0 - of_mass.c0, I.c1 - of_mass.c1, I.c2 - of_mass.c2};
  const double* const entries = numbers(Htilde_omega.c0);
  const V L_g = momentum.w - cross(r_bg, momentum.v);
  namespace loops = cholesky_loops;
  constexpr loops::Size<3> n;
  WideNumber A[9], b[3] = {WideNumber(L_g[0]), WideNumber(L_g[1]), WideNumber(L_g[2])};
  factorize_entries(
      n, [entries](auto i, auto j) { return entries[i + 4 * j]; }, A);
  loops::solve_scaled(A, n, n, b);
  loops::solve_transposed(A, n, n, b);
  const V omega = {b[0].x, b[1].x, b[2].x, 0};
  return {momentum.v * all(inverse_mass) - cross(omega, r_bg), omega};
}

/// Minus the momentum of joint rates, or of their accelerations: what the base makes up for.
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
  const WideSpatial twist = base_twist(arm, minus_momentum(n, arm, phidot));
  store3(Omega, twist.v);
  store3(Omega + 3, twist.w);
}

void wide_torques(const RobotModel& robot, const WideJoints& at, const WideJointMotion& motion,
                  bool base_moves, double* tau) {
  const Joint* const joints = &robot.joints[0];
  const Body* const bodies = &robot.bodies[0];
  const auto n = static_cast<int>(robot.bodies.size());
  WidePose poses[kWideBodies];
  place_bodies(robot, at, poses);
  Wide3x3 inertias[kWideBodies];  // of the bodies about their own centroids
  const WideArm arm(
      robot, [&poses](int k) -> const WidePose& { return poses[k]; },
      [&inertias](int k, const Wide3x3& I) { inertias[k] = I; });
  const WideSpatial none{all(0), all(0)};
  const WideSpatial base =
      base_moves ? base_twist(arm, minus_momentum(n, arm, motion.phidot)) : none;
  double Omega[6];
  store3(Omega, base.v);
  store3(Omega + 3, base.w);
  const WideBaseBias bias = sum_bias(
      robot,
      [&](int k) -> WideBody {
        return {poses[k].R.c2, poses[k].o, poses[k].c, inertias[k]};
      },
      {Omega, motion.phidot}, tau);
  WideSpatial acceleration = none;  // of the base
  if (base_moves) {
    WideSpatial rest = minus_momentum(n, arm, motion.phiddot);
    rest.v -= bias.force;
    rest.w -= bias.moment;
    acceleration = base_twist(arm, rest);
  }
  // H [dot Omega; phi''] as the momentum of these rates.
  WideSpatial twist[kWideBodies], momentum[kWideBodies];
  for (int k = 0; k < n; ++k) {
    const int parent = joints[k].parent;
    const WideSpatial& inherited = parent == kBase ? acceleration : twist[parent];
    twist[k] = {inherited.v + arm.v[k] * all(motion.phiddot[k]),
                inherited.w + arm.w[k] * all(motion.phiddot[k])};
    momentum[k] = momentum_of(twist[k], poses[k].c, inertias[k], bodies[k].mass);
  }
  for (int k = n - 1; k >= 0; --k) {
    const Joint& joint = joints[k];
    const double reflected = joint.gear_ratio * joint.gear_ratio * joint.rotor_inertia;
    tau[k] +=
        sum(arm.v[k] * momentum[k].v + arm.w[k] * momentum[k].w) + reflected * motion.phiddot[k];
    if (joint.parent != kBase) add(momentum[joint.parent], momentum[k]);
  }
}

}  // namespace

}  // namespace stillbase
