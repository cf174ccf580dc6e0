// A sticking contact pushes: its force along the normal is no pull.
#include "formulation/constraints/constraint.hpp"

namespace stillbase {

void add_contact_push(const CaptureModel& model, ConstraintSet& out) {
  if (model.encounter.law != ContactLaw::Sticking) return;
  // n . f, n fixed in the contact frame.
  const auto push = []<class S>(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) -> S {
    const Vector3<S> f = at.impact.response.F.template head<3>();
    const Vector3<S> n = at.impact.encounter.F.template head<3>();
    if (gradient != nullptr) {
      ResponseWeights<S> weights;
      weights.force = n;
      *gradient = at.model.template impact_gradient<S>(at.posture, at.impact, weights);
      at.model.template add_contact_turn<S>(at.placement.rates, f.cross(n), *gradient);
    }
    return n.dot(f);
  };
  add_constraint(out.rows,
                 {.name = "contact_push",
                  .unit = "N s",
                  .lower = 0,
                  .upper = kInfinity,
                  .needs_impact = true,
                  .is_limit = true},
                 push);
}

}  // namespace stillbase
