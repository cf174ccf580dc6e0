// Inertia matrices of the free-floating robot, equations (1), (2), (3), (4), (8).
//
// All quantities are in B; base velocity Omega = [v; omega] with v the velocity of the base
// centroid.
#pragma once

#include <stillbase/dynamics/jacobian.hpp>

namespace stillbase {

/// Inertia of rigidly connected bodies about the base centroid, in B.
template <class S>
struct RigidInertia {
  S m;           ///< mass, kg
  Vector3<S> h;  ///< first moment, mass times centroid, kg m
  Matrix3<S> I;  ///< inertia tensor, kg m^2

  void add(const RigidInertia& other) {
    m += other.m;
    h += other.h;
    I += other.I;
  }
};

/// Blocks of the inertia matrix of (3), and what they say about the whole.
template <class S>
struct InertiaMatrices {
  S mass;                    ///< total mass w, kg
  Vector3<S> r_bg;           ///< system centroid from the base centroid, in B, m (r_gb = -r_bg)
  Matrix6<S> H_b;            ///< base inertia [w E, w skew(r_gb); ., H_omega], (1)
  Matrix6X<S> H_bphi;        ///< inertia coupling matrix [H_vphi; H_omegaphi], (1)
  JointMatrix<S> H_phi;      ///< inertia of the arm on a fixed base, (3)
  PerBody<Matrix3<S>, S> I;  ///< inertia of body k about its own centroid, in B axes
  PerBody<RigidInertia<S>, S> subtree;  ///< all that joint k moves, as one body
};

/// Composite rigid bodies: the inertia of the subtree moved by each joint, summed from the leaves.
/// Differs from (1): prints H_vphi = w d r_gb/d phi; with r_gb pointing to the base the sign is
/// minus.
template <class S>
InertiaMatrices<S> compute_inertia(const RobotModel& robot, const Kinematics<S>& kinematics);
template <>
InertiaMatrices<double> compute_inertia(const RobotModel& robot,
                                        const Kinematics<double>& kinematics);

/// Base translation eliminated ("tilde"), (2) and (8).
template <class S>
struct TildeInertia {
  Matrix3<S>
      Htilde_omega;  ///< H_omega - H_vomega' H_v^-1 H_vomega: central inertia of the locked robot
  Matrix3X<S> Htilde_omegaphi;  ///< H_omegaphi - H_vomega' H_v^-1 H_vphi: angular coupling matrix
  JointMatrix<S> Htilde_phi;    ///< H_phi - H_vphi' H_v^-1 H_vphi
};

template <class S>
TildeInertia<S> compute_tilde_inertia(const InertiaMatrices<S>& inertia);

/// Whole base motion eliminated ("hat"), (4).
template <class S>
struct HatInertia {
  JointMatrix<S> Hhat_phi;  ///< H_phi - H_bphi' H_b^-1 H_bphi: generalized inertia matrix
  Matrix6X<S> Jhat_phi;     ///< J_phi - R_bh H_b^-1 H_bphi: generalized Jacobian
};

template <class S>
HatInertia<S> compute_hat_inertia(const InertiaMatrices<S>& inertia,
                                  const HandJacobian<S>& jacobian);

}  // namespace stillbase
