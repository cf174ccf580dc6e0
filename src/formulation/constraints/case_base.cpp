// Case G2: the impulse gives the base no angular momentum.
#include "formulation/constraints/constraint.hpp"

namespace stillbase {

void add_case_base(const CaptureModel& model, ConstraintSet& out) {
  if (model.problem.constraints.impact_case != CaseConstraint::G2) return;
  for (int i = 0; i < 3; ++i) {
    // Component i in B of Htilde_omega Delta omega per unit of impulse.
    add_constraint(out.rows,
                   {.name = "case_base_" + std::to_string(i + 1),
                    .unit = "m",
                    .lower = 0,
                    .upper = 0,
                    .needs_impact = true,
                    .is_of_case = true},
                   [i]<class S>(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) -> S {
                     if (gradient != nullptr) {
                       ResponseWeights<S> weights;
                       weights.base[i] = S(1);
                       *gradient =
                           at.model.template impact_gradient<S>(at.posture, at.impact, weights);
                     }
                     return at.impact.response.base[i];
                   });
  }
}

}  // namespace stillbase
