#include "dynamics/momentum_kernel.hpp"

namespace stillbase {

template Momentum<double> compute_momentum(const InertiaMatrices<double>&,
                                           const TildeInertia<double>&, const Vector6<double>&,
                                           const JointVector<double>&);
template Vector6<double> free_floating_base_velocity(const InertiaMatrices<double>&,
                                                     const JointVector<double>&);

}  // namespace stillbase
