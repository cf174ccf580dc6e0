#include "impact/contact_response_kernel.hpp"

namespace stillbase {

template ImpactResponse<double> respond_to_contact(const PostureImpact<double>&,
                                                   RigidContact<double>&);
template ContactGradient<double> contact_gradient(const RobotModel&, const PostureImpact<double>&,
                                                  const RigidContact<double>&,
                                                  const ImpactResponse<double>&,
                                                  const ResponseWeights<double>&);
template ContactGradient<double> motion_before_gradient(const RobotModel&,
                                                        const PostureImpact<double>&,
                                                        const RigidContact<double>&,
                                                        const HandMotionWeights<double>&);

}  // namespace stillbase
