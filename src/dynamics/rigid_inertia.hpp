// Inertia of single bodies, about their own centroid and about the base centroid, in B axes.
#pragma once

#include <stillbase/dynamics/inertia.hpp>

namespace stillbase {

/// -m skew(c)^2, the parallel-axis term.
template <class S>
inline Matrix3<S> parallel_axis(const S& m, const Vector3<S>& c) {
  const Vector3<S> h = c * m;
  const S xx = h.x() * c.x(), yy = h.y() * c.y(), zz = h.z() * c.z();
  Matrix3<S> I;
  I(0, 0) = yy + zz;
  I(1, 1) = xx + zz;
  I(2, 2) = xx + yy;
  I(0, 1) = I(1, 0) = -h.x() * c.y();
  I(0, 2) = I(2, 0) = -h.x() * c.z();
  I(1, 2) = I(2, 1) = -h.y() * c.z();
  return I;
}

/// Inertia of body k about its own centroid, in B axes: R I R'.
template <class S, class Robot>
inline Matrix3<S> inertia_in_base_axes(const Robot& robot, const Kinematics<S>& kin, int k) {
  const Matrix3<S> RI = kin.R[k] * robot.bodies[k].inertia.template cast<S>();
  return RI * kin.R[k].transpose();
}

/// Body k about the base centroid.
/// @param I from inertia_in_base_axes()
template <class S, class Robot>
inline RigidInertia<S> inertia_about_base(const Robot& robot, const Kinematics<S>& kin, int k,
                                          const Matrix3<S>& I) {
  const S m(robot.bodies[k].mass);
  return {m, kin.c[k] * m, I + parallel_axis(m, kin.c[k])};
}

/// Momentum [p; L] per twist [v; omega]: 6x6 [m E, -skew(h); skew(h), I], written where it stays.
template <class S>
inline void put_spatial_inertia(const RigidInertia<S>& body, Matrix6<S>& out) {
  out.template topLeftCorner<3, 3>() = Matrix3<S>::Identity() * body.m;
  const Vector3<S>& h = body.h;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    out(i, 3 + i) = out(3 + i, i) = S(0);
    out(3 + k, j) = out(j, 3 + k) = h[i];
    out(3 + j, k) = out(k, 3 + j) = -h[i];
  }
  out.template bottomRightCorner<3, 3>() = body.I;
}

}  // namespace stillbase
