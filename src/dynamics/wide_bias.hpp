// The lines of bias_kernel.hpp in wide registers.
#pragma once

#include "dynamics/wide_vectors.hpp"

namespace stillbase {

namespace {

void wide_bias(const RobotModel& robot, const KnownWidePoses& poses, const double* I,
               const KnownWideMotion& motion, const WideBias& out) {
  const Joint* const joints = &robot.joints[0];
  const Body* const bodies = &robot.bodies[0];
  const auto n = static_cast<int>(robot.bodies.size());
  const V base_omega = load3(motion.Omega + 3);
  const V base_a = cross(base_omega, load3(motion.Omega));
  V z[kWideBodies], o[kWideBodies];
  V omega[kWideBodies], alpha[kWideBodies], a_o[kWideBodies];  // of the bodies, a_o of o
  V f[kWideBodies], t[kWideBodies];  // wrench on the subtree about the base centroid
  for (int k = 0; k < n; ++k) {
    const int parent = joints[k].parent;
    z[k] = load3(poses.R + 9 * k + 6);
    o[k] = load3(poses.o + 3 * k);
    V d = o[k], a = base_a, omega_k = base_omega, alpha_k = all(0);
    if (parent != kBase) {
      d -= o[parent];
      omega_k = omega[parent];
      alpha_k = alpha[parent];
      a = a_o[parent] + cross(alpha_k, d);
    }
    a += cross(omega_k, cross(omega_k, d));
    const V rate = z[k] * all(motion.phidot[k]);
    if (joints[k].type == JointType::Prismatic) {
      a += all(2) * cross(omega_k, rate);
    } else {
      alpha_k += cross(omega_k, rate);
      omega_k += rate;
    }
    omega[k] = omega_k;
    alpha[k] = alpha_k;
    a_o[k] = a;
    const V c = load3(poses.c + 3 * k), r = c - o[k];
    a += cross(alpha_k, r) + cross(omega_k, cross(omega_k, r));
    f[k] = a * all(bodies[k].mass);
    const Wide3x3 I_k = load3x3(I + 9 * k);
    t[k] = times(I_k, alpha_k) + cross(omega_k, times(I_k, omega_k)) + cross(c, f[k]);
  }

  V base_f = base_a * all(robot.base.mass);
  V base_t = cross(base_omega, times(load3x3(numbers(robot.base.inertia)), base_omega));
  for (int k = n - 1; k >= 0; --k) {
    const int parent = joints[k].parent;
    V& parent_f = parent == kBase ? base_f : f[parent];
    V& parent_t = parent == kBase ? base_t : t[parent];
    parent_f += f[k];
    parent_t += t[k];
    const V force =
        z[k] * (joints[k].type == JointType::Prismatic ? f[k] : t[k] - cross(o[k], f[k]));
    out.c_phi[k] = sum(force);
  }
  store3(out.c_b, base_f);
  store3(out.c_b + 3, base_t);
}

}  // namespace

}  // namespace stillbase
