// Margin of the coupling matrix: how far the arm is from losing influence on the base attitude.
#include "formulation/constraints/singular_value_kernel.hpp"

namespace stillbase {

void add_coupling_singular_value(const CaptureModel& model, ConstraintSet& out) {
  const double least = model.problem.constraints.coupling_singular_value_min;
  if (!(least > 0)) return;
  const auto matrix_at = []<class S>(const PostureImpact<S>& posture) {
    return posture.tilde.Htilde_omegaphi;
  };
  const auto gradient_of = []<class S>(const ConstraintPoint<S>& at, const JointVector<S>& v,
                                       const Vector3<S>& u) {
    return coupling_gradient<S>(at.model.problem.robot, at.posture, v, u);
  };
  add_least_singular_value(
      model, out,
      {.name = "coupling_singular_value", .unit = "kg m^2", .lower = least, .upper = kInfinity},
      matrix_at, gradient_of);
}

}  // namespace stillbase
