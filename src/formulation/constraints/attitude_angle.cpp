// Base attitude within an angle of the stated one.
#include <cmath>

#include "formulation/constraints/constraint.hpp"

namespace stillbase {

void add_attitude_angle(const CaptureModel& model, ConstraintSet& out) {
  const VariableSpec& variables = model.problem.variables;
  const double limit = variables.base_attitude_max;
  if (variables.base_attitude == AttitudeFreedom::Cone || model.layout.attitude_size != 3 ||
      limit >= kEveryAttitude) {
    return;
  }
  // Square of the rotation angle from the stated attitude. The rotation vector a is its own image
  // under its right Jacobian: J_r(a)' 2 a = 2 a.
  ConstraintLabel label{"base_attitude_squared", "rad^2", 0, limit * limit};
  label.stated = StatedLimit{"base_attitude", "rad", limit,
                             [](double squared) { return std::sqrt(squared); }, 2 * limit};
  add_constraint(
      out.rows, label, []<class S>(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) -> S {
        const Vector3<S> a = at.placement.x.template segment<3>(at.model.layout.attitude);
        if (gradient != nullptr) gradient->theta = a * S(2);
        return a.squaredNorm();
      });
}

}  // namespace stillbase
