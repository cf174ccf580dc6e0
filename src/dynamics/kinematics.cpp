#include "dynamics/kinematics_kernel.hpp"

namespace stillbase {

template Kinematics<double> compute_kinematics(const RobotModel&, const JointVector<double>&);

}  // namespace stillbase
