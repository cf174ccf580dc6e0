// The lines of bias_kernel.hpp in wide registers.
#pragma once

#include "dynamics/wide_vectors.hpp"

namespace stillbase {

namespace {

/// What the bias forces take of a body: axis and origin of its joint, centroid, and inertia about
/// it.
struct WideBody {
  V z, o, c;
  Wide3x3 I;
};

/// On the base, about its centroid.
struct WideBaseBias {
  V force, moment;
};

/// @param body_of(k) the WideBody @param c_phi takes those of the joints
template <class BodyOf>
[[gnu::always_inline]] inline WideBaseBias sum_bias(const RobotModel& robot, const BodyOf& body_of,
                                                    const KnownWideMotion& motion, double* c_phi) {
  const Joint* const joints = &robot.joints[0];
  const Body* const bodies = &robot.bodies[0];
  const auto n = static_cast<int>(robot.bodies.size());
  const V base_omega = load3(motion.Omega + 3);
  const V base_a = cross(base_omega, load3(motion.Omega));
  V z[kMaxJoints], o[kMaxJoints];
  V omega[kMaxJoints], alpha[kMaxJoints], a_o[kMaxJoints];  // of the bodies, a_o of o
  V f[kMaxJoints], t[kMaxJoints];  // wrench on the subtree about the base centroid
  for (int k = 0; k < n; ++k) {
    const int parent = joints[k].parent;
    const WideBody body = body_of(k);
    z[k] = body.z;
    o[k] = body.o;
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
    const V r = body.c - o[k];
    a += cross(alpha_k, r) + cross(omega_k, cross(omega_k, r));
    f[k] = a * all(bodies[k].mass);
    t[k] = times(body.I, alpha_k) + cross(omega_k, times(body.I, omega_k)) + cross(body.c, f[k]);
  }

  WideBaseBias base{base_a * all(robot.base.mass),
                    cross(base_omega, times(load3x3(numbers(robot.base.inertia)), base_omega))};
  for (int k = n - 1; k >= 0; --k) {
    const int parent = joints[k].parent;
    V& parent_f = parent == kBase ? base.force : f[parent];
    V& parent_t = parent == kBase ? base.moment : t[parent];
    parent_f += f[k];
    parent_t += t[k];
    const V force =
        z[k] * (joints[k].type == JointType::Prismatic ? f[k] : t[k] - cross(o[k], f[k]));
    c_phi[k] = sum(force);
  }
  return base;
}

void wide_bias(const RobotModel& robot, const KnownWidePoses& poses, const double* I,
               const KnownWideMotion& motion, const WideBias& out) {
  const WideBaseBias base = sum_bias(
      robot,
      [&](int k) -> WideBody {
        return {load3(poses.R + 9 * k + 6), load3(poses.o + 3 * k), load3(poses.c + 3 * k),
                load3x3(I + 9 * k)};
      },
      motion, out.c_phi);
  store3(out.c_b, base.force);
  store3(out.c_b + 3, base.moment);
}

}  // namespace

}  // namespace stillbase
