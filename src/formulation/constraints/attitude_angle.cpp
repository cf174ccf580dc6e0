// Base attitude within an angle of the stated one.
#include "formulation/constraints/constraint.hpp"

namespace stillbase {

namespace {

/// Square of the rotation angle from the stated attitude, rad^2.
class AttitudeAngle final : public ConstraintOf<AttitudeAngle> {
 public:
  explicit AttitudeAngle(double limit)
      : ConstraintOf("base_attitude_squared", "rad^2", 0, limit * limit) {}

  template <class S>
  S evaluate(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) const {
    const Vector3<S> a = at.placement.x.template segment<3>(at.model.layout.attitude);
    // The rotation vector a is its own image under its right Jacobian: J_r(a)' 2 a = 2 a.
    if (gradient != nullptr) gradient->theta = a * S(2);
    return a.squaredNorm();
  }
};

}  // namespace

void add_attitude_angle(const CaptureModel& model, ConstraintSet& out) {
  constexpr double kAnyAttitude = 3.14159;  // rad: a limit of half a turn is none
  const VariableSpec& variables = model.problem.variables;
  if (variables.base_attitude == AttitudeFreedom::Cone || model.layout.attitude_size != 3 ||
      variables.base_attitude_max >= kAnyAttitude) {
    return;
  }
  out.rows.push_back(std::make_unique<AttitudeAngle>(variables.base_attitude_max));
}

}  // namespace stillbase
