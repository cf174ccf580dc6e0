#include "dynamics/inertia_factor_kernel.hpp"

namespace stillbase {

template InertiaFactor<double> factorize_inertia(const InertiaMatrices<double>&,
                                                 const JointVectord&, const std::vector<bool>&);
template GeneralizedMotion<double> solve_inertia(const InertiaFactor<double>&,
                                                 const Vector6<double>&,
                                                 const JointVector<double>&);

}  // namespace stillbase
