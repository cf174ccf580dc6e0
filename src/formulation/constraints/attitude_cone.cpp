// An axis of the base within a cone about its stated direction.
#include <algorithm>
#include <cmath>

#include "formulation/constraints/constraint.hpp"

namespace stillbase {

void add_attitude_cone(const CaptureModel& model, ConstraintSet& out) {
  const VariableSpec& variables = model.problem.variables;
  if (variables.base_attitude != AttitudeFreedom::Cone) return;
  // Cosine of the angle of the base's axis from its direction in N.
  const auto cosine = []<class S>(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) -> S {
    const CaptureProblem& problem = at.model.problem;
    const Vector3d& axis = problem.variables.base_attitude_axis;
    const Vector3<S> wanted = axis.cast<S>();
    const Vector3<S> in_base =
        Vector3d(problem.base.orientation.conjugate() * axis).template cast<S>();
    const Matrix3<S>& R_NB = at.placement.R_NB;
    if (gradient != nullptr) {
      gradient->theta = in_base.cross(Vector3<S>(R_NB.transpose() * wanted));
    }
    return wanted.dot(Vector3<S>(R_NB * in_base));
  };
  const double most = variables.base_attitude_max;
  ConstraintLabel label{"base_attitude_cone", "1", std::cos(most), kInfinity};
  label.stated = StatedLimit{"base_attitude", "rad", most,
                             [](double value) { return std::acos(std::clamp(value, -1.0, 1.0)); },
                             -std::sin(most)};
  add_constraint(out.rows, label, cosine);
}

}  // namespace stillbase
