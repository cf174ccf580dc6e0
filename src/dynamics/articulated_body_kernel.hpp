// The lines of <stillbase/dynamics/articulated_body.hpp>, for any number type.
#pragma once

#include <stillbase/dynamics/articulated_body.hpp>

#include <cassert>

#include "dynamics/cholesky.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "dynamics/rigid_inertia.hpp"

namespace stillbase {

template <class S>
ArticulatedBodies<S> factorize_articulated_bodies(const RobotModel& robot, const Kinematics<S>& kin,
                                                  const JointVectord& added_inertia,
                                                  const std::vector<bool>& locked) {
  assert(!robot.is_coupled());
  ArticulatedBodies<S> out;
  BodyWorkspace<Matrix6<S>, S> articulated;
  for (int k = 0; k < kin.n; ++k) {
    out.I[k] = inertia_in_base_axes(robot, kin, k);
    put_spatial_inertia(inertia_about_base(robot, kin, k, out.I[k]), articulated[k]);
    const Vector3<S> z = kin.z(k);
    if (robot.joints[k].is_prismatic()) {
      out.axis[k] << z, Vector3<S>::Zero();
    } else {
      out.axis[k] << kin.o[k].cross(z), z;
    }
  }
  Matrix6<S> base;
  put_spatial_inertia(RigidInertia<S>{S(robot.base.mass), Vector3<S>::Zero(),
                                      robot.base.inertia.template cast<S>()},
                      base);
  for (int k = kin.n - 1; k >= 0; --k) {
    Matrix6<S>& inertia = articulated[k];
    Vector6<S>& U = out.U[k];
    U.noalias() = inertia * out.axis[k];
    if (!locked.empty() && locked[static_cast<std::size_t>(k)]) {
      out.inverse_D[k] = S(0);
    } else {
      const double added = added_inertia[k] + robot.joints[k].reflected_inertia();
      out.inverse_D[k] = S(1) / (out.axis[k].dot(U) + S(added));
    }
    const Vector6<S> share = U * out.inverse_D[k];
    inertia.noalias() -= share * U.transpose();
    const int parent = robot.joints[k].parent;
    (parent == kBase ? base : articulated[parent]) += inertia;
  }
  out.L = base;
  factorize_cholesky(out.L);
  return out;
}

template <class S>
GeneralizedMotion<S> solve_articulated_bodies(const RobotModel& robot,
                                              const ArticulatedBodies<S>& bodies,
                                              const Vector6<S>& F_b, const JointVector<S>& tau) {
  const int n = robot.n();
  BodyWorkspace<Vector6<S>, S> force;  // what subtree k takes from its parent before that one moves
  for (int k = 0; k < n; ++k) force[k].setZero();
  BodyWorkspace<S, S> u;
  GeneralizedMotion<S> out;
  out.Omega = F_b;
  for (int k = n - 1; k >= 0; --k) {
    u[k] = (tau[k] - bodies.axis[k].dot(force[k])) * bodies.inverse_D[k];
    force[k] += bodies.U[k] * u[k];
    const int parent = robot.joints[k].parent;
    if (parent == kBase) {
      out.Omega -= force[k];
    } else {
      force[parent] += force[k];
    }
  }
  solve_cholesky(bodies.L, out.Omega);
  out.phidot.resize(n);
  auto& motion = force;  // the forces are done with
  for (int k = 0; k < n; ++k) {
    const int parent = robot.joints[k].parent;
    const Vector6<S>& inherited = parent == kBase ? out.Omega : motion[parent];
    out.phidot[k] = u[k] - bodies.U[k].dot(inherited) * bodies.inverse_D[k];
    motion[k] = inherited + bodies.axis[k] * out.phidot[k];
  }
  return out;
}

template <class S>
GeneralizedMotion<S> articulated_acceleration(const RobotModel& robot, const Kinematics<S>& kin,
                                              const ArticulatedBodies<S>& bodies,
                                              const Vector6<S>& Omega, const JointVector<S>& phidot,
                                              const Vector6<S>& F_b, const JointVector<S>& tau) {
  const BiasForces<S> bias = compute_bias(robot, kin, bodies.I.data(), Omega, phidot);
  const Vector6<S> base = F_b - bias.c_b;
  const JointVector<S> joints = tau - bias.c_phi;
  return solve_articulated_bodies(robot, bodies, base, joints);
}

}  // namespace stillbase
