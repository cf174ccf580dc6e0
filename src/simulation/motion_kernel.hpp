// Terms and accelerations of the equation of motion (3), for any number type.
#pragma once

#include <type_traits>

#include "dynamics/bias_kernel.hpp"
#include "dynamics/inertia_factor_kernel.hpp"
#include "dynamics/inertia_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"

namespace stillbase {

namespace kernel {

/// @param rotor_inertia n; from added_plant_inertia()
template <class S, class Robot>
InertiaMatrices<S> inertia_with_rotors(const Robot& robot, const Kinematics<S>& kin,
                                       const JointVectord& rotor_inertia) {
  // Of a robot as it is, where compute_inertia() knows a quicker way.
  InertiaMatrices<S> out = [&] {
    if constexpr (std::is_same_v<Robot, RobotModel>)
      return compute_inertia(robot, kin);
    else
      return inertia<S>(robot, kin);
  }();
  for (int k = 0; k < robot.n(); ++k) out.H_phi(k, k) += S(rotor_inertia[k]);
  return out;
}

}  // namespace kernel

/// The terms of (3) at one state, as PlantTerms has them.
template <class S>
struct MotionTerms {
  Kinematics<S> kinematics;
  InertiaMatrices<S> inertia;  ///< H_phi with the rotor inertia on its diagonal
  BiasForces<S> bias;

  /// Members are made where they stay: they are large.
  template <class Robot>
  MotionTerms(const Robot& robot, const JointVectord& rotor_inertia, const JointVector<S>& phi,
              const Vector6<S>& Omega, const JointVector<S>& phidot)
      : kinematics(kernel::kinematics<S>(robot, phi)),
        inertia(kernel::inertia_with_rotors<S>(robot, kinematics, rotor_inertia)),
        bias(kernel::bias<S>(robot, kinematics, inertia.I.data(), Omega, phidot)) {}
};

/// The motion [dot Omega; phi''] of (3) for what acts beside the bias forces.
template <class S>
GeneralizedMotion<S> acceleration_of(const InertiaFactor<S>& factor, const BiasForces<S>& bias,
                                     const Vector6<S>& F_b, const JointVector<S>& tau) {
  const Vector6<S> base = F_b - bias.c_b;
  const JointVector<S> joints = tau - bias.c_phi;
  return solve_inertia<S>(factor, base, joints);
}

/// Kinetic energy 1/2 [Omega; phidot]' H [Omega; phidot].
template <class S>
S kinetic_energy_of(const InertiaMatrices<S>& inertia, const Vector6<S>& Omega,
                    const JointVector<S>& phidot) {
  S twice(0);
  for (Eigen::Index i = 0; i < 6; ++i) {
    S row(0);
    for (Eigen::Index j = 0; j < 6; ++j) row += inertia.H_b(i, j) * Omega[j];
    for (Eigen::Index k = 0; k < phidot.size(); ++k) {
      row += S(2) * inertia.H_bphi(i, k) * phidot[k];
    }
    twice += Omega[i] * row;
  }
  for (Eigen::Index j = 0; j < phidot.size(); ++j) {
    S row(0);
    for (Eigen::Index k = 0; k < phidot.size(); ++k) row += inertia.H_phi(j, k) * phidot[k];
    twice += phidot[j] * row;
  }
  return S(0.5) * twice;
}

}  // namespace stillbase
