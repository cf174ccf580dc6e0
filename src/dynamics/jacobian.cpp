#include "dynamics/jacobian_kernel.hpp"

namespace stillbase {

template HandJacobian<double> compute_hand_jacobian(const RobotModel&, const Kinematics<double>&);

}  // namespace stillbase
