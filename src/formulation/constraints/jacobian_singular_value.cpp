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
  const int rank = generic_rank(model, [&](const PostureImpact<double>& posture) {
    return scaled_generalized_jacobian<double>(posture, length);
  });
  if (rank == 0) return;
  // Least singular value of that matrix, of its generic rank.
  const auto smallest = [rank, length]<class S>(const ConstraintPoint<S>& at,
                                                ScalarGradient<S>* gradient) -> S {
    const SingularTriple<S> triple =
        singular_triple<S>(scaled_generalized_jacobian<S>(at.posture, length), rank);
    if (gradient != nullptr) {  // d sigma = u' dA v
      Vector6<S> u = triple.u;
      u.template tail<3>() *= S(length);
      gradient->phi = generalized_jacobian_gradient<S>(at.model.problem.robot, at.posture,
                                                       JointVector<S>(triple.v), u);
    }
    return triple.sigma;
  };
  add_constraint(out.rows,
                 {.name = "jacobian_singular_value",
                  .unit = "m",
                  .lower = least,
                  .upper = kInfinity,
                  .needs_inertia = true,
                  .is_limit = true},
                 smallest);
}

}  // namespace stillbase
