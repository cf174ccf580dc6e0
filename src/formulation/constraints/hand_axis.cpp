// Approach axis of the hand against the impulse direction; the roll about it is free.
#include "formulation/constraints/constraint.hpp"

namespace stillbase {

namespace {

/// Component of the hand's approach axis along a unit vector e of the contact frame.
class HandAxis final : public ConstraintOf<HandAxis> {
 public:
  HandAxis(const std::string& title, const Vector3d& e, double least)
      : ConstraintOf(title, "1", least, 0), e_(e) {}

  template <class S>
  S evaluate(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) const {
    const Matrix3<S>& R_EB = at.placement.contact.R_EB;
    const Vector3<S> e = e_.cast<S>();
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
  }

 private:
  Vector3d e_;
};

}  // namespace

void add_hand_axis(const CaptureModel& model, ConstraintSet& out) {
  if (model.problem.hand.constraint != HandConstraint::Axis) return;
  const EncounterModel& encounter = model.encounter;
  out.rows.push_back(std::make_unique<HandAxis>("hand_axis_1", encounter.u, 0));
  out.rows.push_back(std::make_unique<HandAxis>("hand_axis_2", encounter.v, 0));
  // Negative when the hand faces the target.
  out.rows.push_back(std::make_unique<HandAxis>("hand_facing", encounter.n, -kInfinity));
}

}  // namespace stillbase
