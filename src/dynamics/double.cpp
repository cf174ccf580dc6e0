// The templates of the room, compiled for double.
#include <cassert>

#include "dynamics/articulated_body_kernel.hpp"
#include "dynamics/bias_kernel.hpp"
#include "dynamics/inertia_factor_kernel.hpp"
#include "dynamics/jacobian_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "dynamics/momentum_kernel.hpp"
#include "dynamics/wide_kernel.hpp"

namespace stillbase {

namespace {

/// Null where the processor has no such registers.
const WideKernel* wide_kernel() {
  static const WideKernel* const kernel = [] {
    const WideKernel* wide = wide_kernel_avx2();
    return wide != nullptr && wide->runs_here() ? wide : nullptr;
  }();
  return kernel;
}

bool is_wide(const RobotModel& robot) {
  return robot.num_bodies() > 0 && robot.num_bodies() <= kWideBodies && wide_kernel() != nullptr;
}

Kinematics<double> kinematics_in_registers(const RobotModel& robot, const JointVectord& phi) {
  assert(phi.size() == robot.n());
  Kinematics<double> kin;
  kernel::make_room(robot.num_bodies(), kin);
  BodyWorkspace<double, double> position;
  for (int k = 0; k < kin.n; ++k) position[k] = kernel::joint_position<double>(robot, phi, k);
  const kernel::JointSines sines(robot, phi);
  wide_kernel()->kinematics(robot, position.data(), sines.sine.data(), sines.cosine.data(),
                            {kin.R.data()->data(), kin.o.data()->data(), kin.c.data()->data()});
  kernel::place_hand(robot, kin);
  return kin;
}

InertiaMatrices<double> inertia_in_registers(const RobotModel& robot,
                                             const Kinematics<double>& kin) {
  static_assert(sizeof(RigidInertia<double>) == 13 * sizeof(double));
  const int n = kin.n;
  InertiaMatrices<double> out;
  out.I.resize(n);
  out.subtree.resize(n);
  out.H_bphi.resize(6, n);
  out.H_phi.resize(n, n);
  RigidInertia<double> total;
  wide_kernel()->inertia(
      robot, {kin.R.data()->data(), kin.o.data()->data(), kin.c.data()->data()},
      {out.I.data()->data(), &out.subtree[0].m, out.H_bphi.data(), out.H_phi.data(), &total.m});
  kernel::describe_whole(total, out);
  return out;
}

}  // namespace

template <>
Kinematics<double> compute_kinematics(const RobotModel& robot, const JointVectord& phi) {
  return is_wide(robot) ? kinematics_in_registers(robot, phi)
                        : kernel::kinematics<double>(robot, phi);
}

template HandJacobian<double> compute_hand_jacobian(const RobotModel&, const Kinematics<double>&);

template <>
InertiaMatrices<double> compute_inertia(const RobotModel& robot, const Kinematics<double>& kin) {
  return is_wide(robot) && !robot.is_coupled() ? inertia_in_registers(robot, kin)
                                               : kernel::inertia<double>(robot, kin);
}

template TildeInertia<double> compute_tilde_inertia(const InertiaMatrices<double>&);
template HatInertia<double> compute_hat_inertia(const InertiaMatrices<double>&,
                                                const HandJacobian<double>&);

template InertiaFactor<double> factorize_inertia(const InertiaMatrices<double>&,
                                                 const JointVectord&, const std::vector<bool>&);
template GeneralizedMotion<double> solve_inertia(const InertiaFactor<double>&, const Vector6d&,
                                                 const JointVectord&);

template BiasForces<double> compute_bias(const RobotModel&, const Kinematics<double>&,
                                         const InertiaMatrices<double>&, const Vector6d&,
                                         const JointVectord&);
template BiasForces<double> compute_bias(const RobotModel&, const Kinematics<double>&,
                                         const Matrix3d*, const Vector6d&, const JointVectord&);
template TildeBias<double> compute_tilde_bias(const InertiaMatrices<double>&,
                                              const BiasForces<double>&);
template JointVectord compute_hat_bias(const InertiaMatrices<double>&, const BiasForces<double>&);

template Momentum<double> compute_momentum(const InertiaMatrices<double>&,
                                           const TildeInertia<double>&, const Vector6d&,
                                           const JointVectord&);
template Vector6d free_floating_base_velocity(const InertiaMatrices<double>&, const JointVectord&);

template ArticulatedBodies<double> factorize_articulated_bodies(const RobotModel&,
                                                                const Kinematics<double>&,
                                                                const JointVectord&,
                                                                const std::vector<bool>&);
template GeneralizedMotion<double> solve_articulated_bodies(const RobotModel&,
                                                            const ArticulatedBodies<double>&,
                                                            const Vector6d&, const JointVectord&);
template GeneralizedMotion<double> articulated_acceleration(const RobotModel&,
                                                            const Kinematics<double>&,
                                                            const ArticulatedBodies<double>&,
                                                            const Vector6d&, const JointVectord&,
                                                            const Vector6d&, const JointVectord&);

}  // namespace stillbase
