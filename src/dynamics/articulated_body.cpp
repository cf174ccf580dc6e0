#include "dynamics/articulated_body_kernel.hpp"

namespace stillbase {

template ArticulatedBodies<double> factorize_articulated_bodies(const RobotModel&,
                                                                const Kinematics<double>&,
                                                                const JointVectord&,
                                                                const std::vector<bool>&);
template GeneralizedMotion<double> solve_articulated_bodies(const RobotModel&,
                                                            const ArticulatedBodies<double>&,
                                                            const Vector6<double>&,
                                                            const JointVector<double>&);
template GeneralizedMotion<double> articulated_acceleration(
    const RobotModel&, const Kinematics<double>&, const ArticulatedBodies<double>&,
    const Vector6<double>&, const JointVector<double>&, const Vector6<double>&,
    const JointVector<double>&);

}  // namespace stillbase
