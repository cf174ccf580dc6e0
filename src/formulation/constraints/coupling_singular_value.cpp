// Margin of the coupling matrix: how far the arm is from losing influence on the base attitude.
#include "formulation/constraints/singular_value_kernel.hpp"

namespace stillbase {

void add_coupling_singular_value(const CaptureModel& model, ConstraintSet& out) {
  const double least = model.problem.constraints.coupling_singular_value_min;
  if (!(least > 0)) return;
  const int rank = generic_rank(model, [](const PostureImpact<double>& posture) {
    return Eigen::MatrixXd(posture.tilde.Htilde_omegaphi);
  });
  if (rank == 0) return;
  // Least singular value of Htilde_omegaphi, of its generic rank.
  const auto smallest = [rank]<class S>(const ConstraintPoint<S>& at,
                                        ScalarGradient<S>* gradient) -> S {
    const SingularTriple<S> triple = singular_triple<S>(at.posture.tilde.Htilde_omegaphi, rank);
    if (gradient != nullptr) {  // d sigma = u' dA v
      gradient->phi = coupling_gradient<S>(at.model.problem.robot, at.posture,
                                           JointVector<S>(triple.v), Vector3<S>(triple.u));
    }
    return triple.sigma;
  };
  add_constraint(out.rows,
                 {.name = "coupling_singular_value",
                  .unit = "kg m^2",
                  .lower = least,
                  .upper = kInfinity,
                  .needs_inertia = true,
                  .is_limit = true},
                 smallest);
}

}  // namespace stillbase
