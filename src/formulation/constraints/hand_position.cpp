// Hand at its point: the contact feature, or a stated point.
#include "formulation/constraints/hand_point_kernel.hpp"

namespace stillbase {

void add_hand_position(const CaptureModel& model, ConstraintSet& out) {
  const bool is_fixed = model.problem.variables.base_position == PositionFreedom::Fixed;
  if (model.problem.hand.constraint == HandConstraint::None || !has_hand_point(model) ||
      !is_fixed) {
    return;
  }
  for (int i = 0; i < 3; ++i) {
    // Component i of the hand's distance from its point; in N, or in B with a point stated there.
    const auto component = [i]<class S>(const ConstraintPoint<S>& at,
                                        ScalarGradient<S>* gradient) -> S {
      const EncounterModel& encounter = at.model.encounter;
      const Vector3<S>& r_bh = at.posture.kinematics.r_bh;
      if (encounter.hand_point && encounter.hand_frame == Frame::Base) {
        if (gradient != nullptr) gradient->phi = at.posture.jacobian.J_phi.row(i).transpose();
        return r_bh[i] - S((*encounter.hand_point)[i]);
      }
      if (gradient != nullptr) add_hand_point_gradient<S>(at, i, S(1), *gradient);
      const S from_base = at.placement.R_NB.row(i).dot(r_bh);
      return from_base + S(at.model.problem.base.position[i]) - wanted_hand_point<S>(at)[i];
    };
    add_constraint(out.rows, {std::string("hand_position_") + kAxisNames[i], "m", 0, 0}, component);
  }
}

}  // namespace stillbase
