// Margin of the generalized Jacobian: how far the hand is from losing a direction of motion.
#include <stillbase/dynamics/inertia.hpp>

#include "formulation/constraints/singular_value_kernel.hpp"

namespace stillbase {

namespace {

template <class S>
using FreeMatrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;

/// Jhat_phi with its angular rows times a length, m.
template <class S>
FreeMatrix<S> scaled_generalized_jacobian(const PostureImpact<S>& posture, double length) {
  FreeMatrix<S> A = compute_hat_inertia<S>(posture.inertia, posture.jacobian).Jhat_phi;
  A.bottomRows(3) *= S(length);
  return A;
}

}  // namespace

void add_jacobian_singular_value(const CaptureModel& model, ConstraintSet& out) {
  const double least = model.problem.constraints.jacobian_singular_value_min;
  const double length = model.problem.constraints.jacobian_length;
  if (!(least > 0)) return;
  const auto matrix_at = [length]<class S>(const PostureImpact<S>& posture) {
    return scaled_generalized_jacobian<S>(posture, length);
  };
  const auto gradient_of = [length]<class S>(const ConstraintPoint<S>& at, const JointVector<S>& v,
                                             Vector6<S> u) {
    u.template tail<3>() *= S(length);
    return generalized_jacobian_gradient<S>(at.model.problem.robot, at.posture, v, u);
  };
  add_least_singular_value(
      model, out,
      {.name = "jacobian_singular_value", .unit = "m", .lower = least, .upper = kInfinity},
      matrix_at, gradient_of);
}

}  // namespace stillbase
