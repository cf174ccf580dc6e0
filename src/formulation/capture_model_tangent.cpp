// The kernel on Tangent, for exact second derivatives: placement and impact.
#include "dynamics/inertia_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "formulation/capture_model_kernel.hpp"
#include "impact/contact_response_kernel.hpp"
#include "impact/gradient_kernel.hpp"
#include "impact/jump_kernel.hpp"

namespace stillbase {

template PostureImpact<Tangent> evaluate_posture(const RobotModel&, const ImpactResistance&,
                                                 const JointVector<Tangent>&);
template ImpactResponse<Tangent> respond(const PostureImpact<Tangent>&, const Vector6<Tangent>&);
template ResponseGradient<Tangent> response_gradient(const RobotModel&,
                                                     const PostureImpact<Tangent>&,
                                                     const ImpactResponse<Tangent>&,
                                                     const ResponseWeights<Tangent>&);
template ImpactResponse<Tangent> respond_to_contact(const PostureImpact<Tangent>&,
                                                    RigidContact<Tangent>&);
template ContactGradient<Tangent> contact_gradient(const RobotModel&, const PostureImpact<Tangent>&,
                                                   const RigidContact<Tangent>&,
                                                   const ImpactResponse<Tangent>&,
                                                   const ResponseWeights<Tangent>&);
template ContactGradient<Tangent> motion_before_gradient(const RobotModel&,
                                                         const PostureImpact<Tangent>&,
                                                         const RigidContact<Tangent>&,
                                                         const HandMotionWeights<Tangent>&);
template JointVector<Tangent> coupling_column_gradient(const RobotModel&,
                                                       const PostureImpact<Tangent>&, int,
                                                       const Vector3<Tangent>&);
template JointVector<Tangent> coupling_gradient(const RobotModel&, const PostureImpact<Tangent>&,
                                                const JointVector<Tangent>&,
                                                const Vector3<Tangent>&);
template JointVector<Tangent> generalized_jacobian_gradient(const RobotModel&,
                                                            const PostureImpact<Tangent>&,
                                                            const JointVector<Tangent>&,
                                                            const Vector6<Tangent>&);
template HatInertia<Tangent> compute_hat_inertia(const InertiaMatrices<Tangent>&,
                                                 const HandJacobian<Tangent>&);
template Matrix3<Tangent> wanted_hand_axes(const EncounterModel&, const Matrix3<Tangent>&,
                                           const Matrix3<Tangent>&);

STILLBASE_INSTANTIATE_CAPTURE_MODEL(Tangent);

}  // namespace stillbase
