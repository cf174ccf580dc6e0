// The planner's templates of kinematics and inertia, compiled for enclosing numbers.
#include "dynamics/inertia_kernel.hpp"
#include "dynamics/jacobian_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "proof/dual.hpp"
#include "proof/taylor.hpp"

#define STILLBASE_INSTANTIATE(S)                                                           \
  template Kinematics<S> compute_kinematics(const RobotModel&, const JointVector<S>&);     \
  template InertiaMatrices<S> compute_inertia(const RobotModel&, const Kinematics<S>&);    \
  template HandJacobian<S> compute_hand_jacobian(const RobotModel&, const Kinematics<S>&); \
  template TildeInertia<S> compute_tilde_inertia(const InertiaMatrices<S>&);

namespace stillbase {

STILLBASE_INSTANTIATE(proof::Dual)
STILLBASE_INSTANTIATE(proof::Quadratic<2>)
STILLBASE_INSTANTIATE(proof::Quadratic<3>)

}  // namespace stillbase
