// Rates of the joints right after the nominal impact.
#include <cmath>

#include "formulation/constraints/constraint.hpp"

namespace stillbase {

void add_joint_rate(const CaptureModel& model, ConstraintSet& out) {
  const ConstraintSpec& wanted = model.problem.constraints;
  for (int k = 0; k < model.n(); ++k) {
    const Joint& joint = model.problem.robot.joints[static_cast<std::size_t>(k)];
    double limit = kInfinity;
    if (wanted.joint_rate_scale) limit = *wanted.joint_rate_scale * joint.max_velocity;
    if (wanted.joint_rate_max.size() == model.n()) limit = wanted.joint_rate_max[k];
    if (!std::isfinite(limit)) continue;
    // p Delta phidot_k.
    const auto rate = [k]<class S>(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) -> S {
      const S value = at.impact.p * at.impact.response.d.Delta_phidot[k];
      if (gradient != nullptr) {
        ResponseWeights<S> weights;
        weights.phidot.setZero(at.model.n());
        weights.phidot[k] = at.impact.p;
        *gradient = at.model.template scaled_gradient<S>(at.posture, at.impact, weights, value);
      }
      return value;
    };
    const char* const unit = joint.is_prismatic() ? "m/s" : "rad/s";
    add_constraint(out.rows,
                   {.name = "joint_rate_" + joint.name,
                    .unit = unit,
                    .lower = -limit,
                    .upper = limit,
                    .needs_impact = true,
                    .is_limit = true},
                   rate);
  }
}

}  // namespace stillbase
