// Case G2: the impulse gives the base no angular momentum.
#include "formulation/constraints/constraint.hpp"

namespace stillbase {

namespace {

/// Component i in B of Htilde_omega Delta omega per unit of impulse, m, = 0.
class CaseBase final : public ConstraintOf<CaseBase> {
 public:
  explicit CaseBase(int i) : ConstraintOf("case_base_" + std::to_string(i + 1), "m", 0, 0), i_(i) {
    needs_impact = is_of_case = true;
  }

  template <class S>
  S evaluate(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) const {
    if (gradient != nullptr) {
      ResponseWeights<S> weights;
      weights.base[i_] = S(1);
      *gradient = at.model.template impact_gradient<S>(at.posture, at.impact, weights);
    }
    return at.impact.response.base[i_];
  }

 private:
  int i_;
};

}  // namespace

void add_case_base(const CaptureModel& model, ConstraintSet& out) {
  if (model.problem.constraints.impact_case != CaseConstraint::G2) return;
  for (int i = 0; i < 3; ++i) out.rows.push_back(std::make_unique<CaseBase>(i));
}

}  // namespace stillbase
