#include "impact/gradient_kernel.hpp"

namespace stillbase {

ImpactResistance prepare_resistance(const JointResistance& resistance, int n) {
  ImpactResistance out{added_impact_inertia(resistance, n), {}};
  if (resistance.model == ResistanceModel::Locked) out.locked = resistance.locked;
  return out;
}

template PostureImpact<double> evaluate_posture(const RobotModel&, const ImpactResistance&,
                                                const JointVector<double>&);
template PostureImpact<double> evaluate_hand(const RobotModel&, const JointVector<double>&);
template ImpactResponse<double> respond(const PostureImpact<double>&, const Vector6<double>&);
template ResponseGradient<double> response_gradient(const RobotModel&, const PostureImpact<double>&,
                                                    const ImpactResponse<double>&,
                                                    const ResponseWeights<double>&);
template JointVector<double> coupling_column_gradient(const RobotModel&,
                                                      const PostureImpact<double>&, int,
                                                      const Vector3<double>&);
template JointVector<double> coupling_gradient(const RobotModel&, const PostureImpact<double>&,
                                               const JointVector<double>&, const Vector3<double>&);
template JointVector<double> generalized_jacobian_gradient(const RobotModel&,
                                                           const PostureImpact<double>&,
                                                           const JointVector<double>&,
                                                           const Vector6<double>&);

}  // namespace stillbase
