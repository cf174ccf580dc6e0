// Rates of the joints right after the nominal impact.
#include <cmath>

#include "formulation/constraints/constraint.hpp"

namespace stillbase {

namespace {

/// p Delta phidot_k of joint k, rad/s (m/s).
class JointRate final : public ConstraintOf<JointRate> {
 public:
  JointRate(int k, const Joint& joint, double limit)
      : ConstraintOf("joint_rate_" + joint.name, joint.is_prismatic() ? "m/s" : "rad/s", -limit,
                     limit),
        k_(k) {
    needs_impact = true;
  }

  template <class S>
  S evaluate(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) const {
    const S rate = at.impact.p * at.impact.response.d.Delta_phidot[k_];
    if (gradient != nullptr) {
      ResponseWeights<S> weights;
      weights.phidot.setZero(at.model.n());
      weights.phidot[k_] = at.impact.p;
      *gradient = at.model.template scaled_gradient<S>(at.posture, at.impact, weights, rate);
    }
    return rate;
  }

 private:
  int k_;
};

}  // namespace

void add_joint_rate(const CaptureModel& model, ConstraintSet& out) {
  const ConstraintSpec& wanted = model.problem.constraints;
  for (int k = 0; k < model.n(); ++k) {
    const Joint& joint = model.problem.robot.joints[static_cast<std::size_t>(k)];
    double limit = kInfinity;
    if (wanted.joint_rate_scale) limit = *wanted.joint_rate_scale * joint.max_velocity;
    if (wanted.joint_rate_max.size() == model.n()) limit = wanted.joint_rate_max[k];
    if (!std::isfinite(limit)) continue;
    out.rows.push_back(std::make_unique<JointRate>(k, joint, limit));
  }
}

}  // namespace stillbase
