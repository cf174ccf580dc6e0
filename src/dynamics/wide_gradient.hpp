// The sums over the tree of impact/gradient_kernel.hpp in wide registers.
#pragma once

#include "dynamics/wide_spatial.hpp"

namespace stillbase {

namespace {

/// Twist of body k's joint under unit rate.
[[gnu::always_inline]] inline WideSpatial unit_twist(const Joint& joint,
                                                     const KnownWidePoses& poses, int k) {
  const V z = load3(poses.R + 9 * k + 6);
  if (joint.type == JointType::Prismatic) return {z, all(0)};
  return {cross(load3(poses.o + 3 * k), z), z};
}

/// a x b with its entries turned by one place: a sum of products is turned back once.
[[gnu::always_inline]] inline V turned_cross(const V& a, const V& b) {
  return a * lanes<1, 2, 0, 3>(b) - lanes<1, 2, 0, 3>(a) * b;
}
[[gnu::always_inline]] inline V turned_back(const V& turned) { return lanes<1, 2, 0, 3>(turned); }

/// The lines of add_motion_gradient().
void wide_motion_gradient(const RobotModel& robot, const KnownWidePoses& poses, const double* I,
                          const WideHandLoads& hand, const WideLoadedMotion& a,
                          const WideLoadedMotion& b, double* gradient) {
  const Joint* const joints = &robot.joints[0];
  const Body* const bodies = &robot.bodies[0];
  const auto n = static_cast<int>(robot.bodies.size());
  WideSpatial axes[kWideBodies];
  WideSpatial V_a[kWideBodies], P_a[kWideBodies], V_b[kWideBodies], P_b[kWideBodies];
  const WideSpatial base_a{load3(a.Omega), load3(a.Omega + 3)};
  const WideSpatial base_b{load3(b.Omega), load3(b.Omega + 3)};
  for (int k = 0; k < n; ++k) {
    const int parent = joints[k].parent;
    axes[k] = unit_twist(joints[k], poses, k);
    const V c = load3(poses.c + 3 * k);
    const Wide3x3 I_k = load3x3(I + 9 * k);
    const auto move = [&](const WideSpatial& inherited, double rate, WideSpatial& twist,
                          WideSpatial& momentum) {
      twist.v = inherited.v + axes[k].v * all(rate);
      twist.w = inherited.w + axes[k].w * all(rate);
      momentum = momentum_of(twist, c, I_k, bodies[k].mass);
    };
    move(parent == kBase ? base_a : V_a[parent], a.phidot[k], V_a[k], P_a[k]);
    move(parent == kBase ? base_b : V_b[parent], b.phidot[k], V_b[k], P_b[k]);
  }
  if (robot.hand_body != kBase) {
    const V r_bh = load3(hand.r_bh);
    const auto load = [&](const double* F, WideSpatial& momentum) {
      const V f = load3(F);
      momentum.v -= f;
      momentum.w -= load3(F + 3) + cross(r_bh, f);
    };
    load(a.F, P_a[robot.hand_body]);
    load(b.F, P_b[robot.hand_body]);
  }
  for (int k = n - 1; k >= 0; --k) {
    const V linear = turned_cross(V_a[k].w, P_b[k].v) + turned_cross(V_b[k].w, P_a[k].v);
    const V angular = (turned_cross(V_a[k].v, P_b[k].v) + turned_cross(V_b[k].v, P_a[k].v)) +
                      (turned_cross(V_a[k].w, P_b[k].w) + turned_cross(V_b[k].w, P_a[k].w));
    gradient[k] += sum(axes[k].v * turned_back(linear) + axes[k].w * turned_back(angular));
    const int parent = joints[k].parent;
    if (parent == kBase) continue;
    add(P_a[parent], P_a[k]);
    add(P_b[parent], P_b[k]);
  }
  const V moment = load3(hand.moment);
  for (int k = robot.hand_body; k != kBase; k = joints[k].parent) {
    gradient[k] += sum(axes[k].w * moment);
  }
}

/// The lines of add_locked_rotation_gradient(), with z and v taken out.
void wide_rotation_gradient(const RobotModel& robot, const KnownWidePoses& poses,
                            const double* subtrees, const WideRotations& rotations,
                            double* gradient) {
  const Joint* const joints = &robot.joints[0];
  const auto n = static_cast<int>(robot.bodies.size());
  const V r = load3(rotations.r_bg), u = load3(rotations.u), w = load3(rotations.w);
  const V uw = all(2 * sum(u * w)), ur = all(sum(u * r)), wr = all(sum(w * r));
  for (int k = 0; k < n; ++k) {
    const double* const subtree = subtrees + 13 * k;
    const V h_b = load3(subtree + 1), h = h_b - r * all(subtree[0]);
    const Wide3x3 I = load3x3(subtree + 4);
    const V uh = all(sum(u * h)), wh = all(sum(w * h));
    const V Lw = r * wh + h_b * wr + times(I, w);
    const V Lu = r * uh + h_b * ur + times(I, u);
    const WideSpatial axis = unit_twist(joints[k], poses, k);
    const V v = axis.v + cross(axis.w, r);
    const V turning = turned_back(turned_cross(u, Lw) + turned_cross(w, Lu));
    gradient[k] += sum(v * (h * uw - w * uh - u * wh) - axis.w * turning);
  }
}

}  // namespace

}  // namespace stillbase
