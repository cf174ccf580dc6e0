// The templates of the room, compiled for double.
#include "dynamics/articulated_body_kernel.hpp"
#include "dynamics/bias_kernel.hpp"
#include "dynamics/inertia_factor_kernel.hpp"
#include "dynamics/jacobian_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "dynamics/momentum_kernel.hpp"

namespace stillbase {

template Kinematics<double> compute_kinematics(const RobotModel&, const JointVectord&);
template HandJacobian<double> compute_hand_jacobian(const RobotModel&, const Kinematics<double>&);

template InertiaMatrices<double> compute_inertia(const RobotModel&, const Kinematics<double>&);
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
