// Velocity-dependent forces c_b, c_phi of (3) and their reduced forms.
//
// The equation of motion (3) is for the derivative of the *B components* of Omega, so the bias
// holds the transport terms of the turning frame (m omega x v, ...).
#pragma once

#include <stillbase/dynamics/inertia.hpp>

namespace stillbase {

template <class S>
struct BiasForces {
  Vector6<S> c_b;        ///< at the base, [force; moment about the base centroid], N, N m
  JointVector<S> c_phi;  ///< at the joints (n), N m or N
};

/// Recursive Newton-Euler with zero generalised accelerations.
/// @param Omega base velocity [v; omega] in B
/// @param phidot joint rates (n)
template <class S>
BiasForces<S> compute_bias(const RobotModel& robot, const Kinematics<S>& kinematics,
                           const InertiaMatrices<S>& inertia, const Vector6<S>& Omega,
                           const JointVector<S>& phidot);

/// The same with the inertias of the bodies alone.
/// @param I of body k about its own centroid, in B axes, kg m^2; n of them
template <class S>
BiasForces<S> compute_bias(const RobotModel& robot, const Kinematics<S>& kinematics,
                           const Matrix3<S>* I, const Vector6<S>& Omega,
                           const JointVector<S>& phidot);
template <>
BiasForces<double> compute_bias(const RobotModel& robot, const Kinematics<double>& kinematics,
                                const Matrix3d* I, const Vector6d& Omega,
                                const JointVectord& phidot);

/// Bias with base translation eliminated, (8).
template <class S>
struct TildeBias {
  Vector3<S> ctilde_omega;    ///< c_omega - H_vomega' H_v^-1 c_v
  JointVector<S> ctilde_phi;  ///< c_phi - H_vphi' H_v^-1 c_v
};

template <class S>
TildeBias<S> compute_tilde_bias(const InertiaMatrices<S>& inertia, const BiasForces<S>& bias);

/// chat = c_phi - H_bphi' H_b^-1 c_b, (4).
template <class S>
JointVector<S> compute_hat_bias(const InertiaMatrices<S>& inertia, const BiasForces<S>& bias);

}  // namespace stillbase
