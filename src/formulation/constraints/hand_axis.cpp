// Approach axis of the hand against the impulse direction; the roll about it is free.
#include "formulation/constraints/constraint.hpp"

namespace stillbase {

void add_hand_axis(const CaptureModel& model, ConstraintSet& out) {
  if (model.problem.hand.constraint != HandConstraint::Axis) return;
  // Component of the hand's approach axis along a unit vector e of the contact frame.
  const auto add = [&out](const char* name, const Vector3d& direction, double least) {
    const auto component = [direction]<class S>(const ConstraintPoint<S>& at,
                                                ScalarGradient<S>* gradient) -> S {
      const Matrix3<S>& R_EB = at.placement.contact.R_EB;
      const Vector3<S> e = direction.cast<S>();  // NOLINT: a copy of doubles alone
      const Vector3<S> axis =
          at.posture.kinematics.R_hand * at.model.encounter.approach_axis.template cast<S>();
      if (gradient != nullptr) {
        const Vector3<S> e_B = R_EB.transpose() * e;
        for (int k = 0; k < at.model.n(); ++k) {
          const Vector3<S> turn = at.posture.jacobian.J_phi.template block<3, 1>(3, k);
          gradient->phi[k] = turn.cross(axis).dot(e_B);
        }
        at.model.template add_contact_turn<S>(at.placement.rates, axis.cross(e_B), *gradient);
      }
      return e.dot(Vector3<S>(R_EB * axis));
    };
    add_constraint(out.rows, {name, "1", least, 0}, component);
  };
  const EncounterModel& encounter = model.encounter;
  add("hand_axis_1", encounter.u, 0);
  add("hand_axis_2", encounter.v, 0);
  add("hand_facing", encounter.n, -kInfinity);  // negative when the hand faces the target
}

}  // namespace stillbase
