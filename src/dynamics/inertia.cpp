#include "dynamics/inertia_kernel.hpp"

namespace stillbase {

template InertiaMatrices<double> compute_inertia(const RobotModel&, const Kinematics<double>&);
template TildeInertia<double> compute_tilde_inertia(const InertiaMatrices<double>&);
template HatInertia<double> compute_hat_inertia(const InertiaMatrices<double>&,
                                                const HandJacobian<double>&);

}  // namespace stillbase
