#include "dynamics/bias_kernel.hpp"

namespace stillbase {

template BiasForces<double> compute_bias(const RobotModel&, const Kinematics<double>&,
                                         const InertiaMatrices<double>&, const Vector6<double>&,
                                         const JointVector<double>&);
template BiasForces<double> compute_bias(const RobotModel&, const Kinematics<double>&,
                                         const PerBody<Matrix3<double>, double>&,
                                         const Vector6<double>&, const JointVector<double>&);
template TildeBias<double> compute_tilde_bias(const InertiaMatrices<double>&,
                                              const BiasForces<double>&);
template JointVector<double> compute_hat_bias(const InertiaMatrices<double>&,
                                              const BiasForces<double>&);

}  // namespace stillbase
