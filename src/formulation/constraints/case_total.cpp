// Cases C, C1 and C2: the impulse gives the system no angular momentum about its centroid.
#include "formulation/constraints/constraint.hpp"

namespace stillbase {

void add_case_total(const CaptureModel& model, ConstraintSet& out) {
  const CaseConstraint wanted = model.problem.constraints.impact_case;
  if (wanted != CaseConstraint::C && wanted != CaseConstraint::C1 && wanted != CaseConstraint::C2) {
    return;
  }
  // Component of Delta L_g per unit of impulse along a unit vector e of the contact frame.
  const auto add = [&out](const char* name, const Vector3d& axis) {
    const auto component = [axis]<class S>(const ConstraintPoint<S>& at,
                                           ScalarGradient<S>* gradient) -> S {
      const Matrix3<S>& R_EB = at.placement.contact.R_EB;
      const Vector3<S>& total = at.impact.response.total;
      const Vector3<S>& e = axis.cast<S>();
      if (gradient != nullptr) {
        ResponseWeights<S> weights;
        weights.total = R_EB.transpose() * e;
        *gradient = at.model.template impact_gradient<S>(at.posture, at.impact, weights);
        at.model.template add_contact_turn<S>(at.placement.rates, total.cross(weights.total),
                                              *gradient);
      }
      return e.dot(Vector3<S>(R_EB * total));
    };
    add_constraint(out.rows,
                   {.name = name,
                    .unit = "m",
                    .lower = 0,
                    .upper = 0,
                    .needs_impact = true,
                    .is_of_case = true},
                   component);
  };
  // r_gh x n is normal to n: two independent rows. Of a sticking contact, whose force is not normal
  // to n, the total vanishes with these two as well. A latch gives a moment.
  const EncounterModel& encounter = model.encounter;
  add("case_total_1", encounter.u);
  add("case_total_2", encounter.v);
  const bool has_moment = !encounter.moment.isZero(0) || encounter.law == ContactLaw::Latch;
  if (has_moment) add("case_total_3", encounter.n);
}

}  // namespace stillbase
