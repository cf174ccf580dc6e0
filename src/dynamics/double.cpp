// The templates of the room, compiled for double.
#include <cassert>

#include "dynamics/articulated_body_kernel.hpp"
#include "dynamics/bias_kernel.hpp"
#include "dynamics/inertia_factor_kernel.hpp"
#include "dynamics/jacobian_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "dynamics/momentum_kernel.hpp"
#include "dynamics/wide_joint_values.hpp"

namespace stillbase {

namespace {

Kinematics<double> kinematics_in_registers(const WideKernel& kernel, const RobotModel& robot,
                                           const JointVectord& phi) {
  assert(phi.size() == robot.n());
  Kinematics<double> kin;
  stillbase::kernel::make_room(robot.num_bodies(), kin);
  const WideJointValues joints(robot, phi);
  kernel.kinematics(robot, joints.plain(),
                    {kin.R.data()->data(), kin.o.data()->data(), kin.c.data()->data()});
  stillbase::kernel::place_hand(robot, kin);
  return kin;
}

KnownWidePoses poses_of(const Kinematics<double>& kin) {
  return {kin.R.data()->data(), kin.o.data()->data(), kin.c.data()->data()};
}

InertiaMatrices<double> inertia_in_registers(const WideKernel& kernel, const RobotModel& robot,
                                             const Kinematics<double>& kin) {
  static_assert(sizeof(RigidInertia<double>) == 13 * sizeof(double));
  const int n = kin.n;
  InertiaMatrices<double> out;
  out.I.resize(n);
  out.subtree.resize(n);
  out.H_bphi.resize(6, n);
  out.H_phi.resize(n, n);
  RigidInertia<double> total;
  kernel.inertia(
      robot, poses_of(kin),
      {out.I.data()->data(), &out.subtree[0].m, out.H_bphi.data(), out.H_phi.data(), &total.m});
  stillbase::kernel::describe_whole(total, out);
  return out;
}

}  // namespace

template <>
Kinematics<double> compute_kinematics(const RobotModel& robot, const JointVectord& phi) {
  const WideKernel* const wide = wide_passes(robot);
  return wide != nullptr ? kinematics_in_registers(*wide, robot, phi)
                         : kernel::kinematics<double>(robot, phi);
}

template HandJacobian<double> compute_hand_jacobian(const RobotModel&, const Kinematics<double>&);

template <>
InertiaMatrices<double> compute_inertia(const RobotModel& robot, const Kinematics<double>& kin) {
  const WideKernel* const wide = wide_kernel(robot);
  return wide != nullptr ? inertia_in_registers(*wide, robot, kin)
                         : kernel::inertia<double>(robot, kin);
}

template TildeInertia<double> compute_tilde_inertia(const InertiaMatrices<double>&);
template HatInertia<double> compute_hat_inertia(const InertiaMatrices<double>&,
                                                const HandJacobian<double>&);

template InertiaFactor<double> factorize_inertia(const InertiaMatrices<double>&,
                                                 const JointVectord&, const std::vector<bool>&);
template GeneralizedMotion<double> solve_inertia(const InertiaFactor<double>&, const Vector6d&,
                                                 const JointVectord&);

template <>
BiasForces<double> compute_bias(const RobotModel& robot, const Kinematics<double>& kin,
                                const Matrix3d* I, const Vector6d& Omega,
                                const JointVectord& phidot) {
  assert(phidot.size() == robot.n());
  const WideKernel* const wide = wide_passes(robot);
  if (wide == nullptr || robot.is_coupled()) {
    return kernel::bias<double>(robot, kin, I, Omega, phidot);
  }
  BiasForces<double> out;
  out.c_phi.resize(kin.n);
  wide->bias(robot, poses_of(kin), I->data(), {Omega.data(), phidot.data()},
             {out.c_b.data(), out.c_phi.data()});
  return out;
}
template BiasForces<double> compute_bias(const RobotModel&, const Kinematics<double>&,
                                         const InertiaMatrices<double>&, const Vector6d&,
                                         const JointVectord&);
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
