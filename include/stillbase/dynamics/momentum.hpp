// Linear momentum and angular momentum about the system centroid, (1) and (2), in B components.
#pragma once

#include <stillbase/dynamics/inertia.hpp>

namespace stillbase {

template <class S>
struct Momentum {
  Vector3<S> P;         ///< linear momentum, N s
  Vector3<S> L_g;       ///< angular momentum about the system centroid, N m s; = base + coupling
  Vector3<S> base;      ///< Htilde_omega omega, (2)
  Vector3<S> coupling;  ///< Htilde_omegaphi phidot, (2)
};

template <class S>
Momentum<S> compute_momentum(const InertiaMatrices<S>& inertia, const TildeInertia<S>& tilde,
                             const Vector6<S>& Omega, const JointVector<S>& phidot);

/// Base velocity that a robot with zero momentum has while its joints move:
/// Omega = -H_b^-1 H_bphi phidot.
template <class S>
Vector6<S> free_floating_base_velocity(const InertiaMatrices<S>& inertia,
                                       const JointVector<S>& phidot);

}  // namespace stillbase
