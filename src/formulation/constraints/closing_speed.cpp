// Closing speed of hand and target along the nominal direction.
#include "formulation/constraints/constraint.hpp"

namespace stillbase {

namespace {

class ClosingSpeed final : public ConstraintOf<ClosingSpeed> {
 public:
  explicit ClosingSpeed(double least) : ConstraintOf("closing_speed", "m/s", least, kInfinity) {
    needs_impact = true;
  }

  template <class S>
  S evaluate(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) const {
    if (gradient != nullptr) gradient->t = at.impact.closing_speed_rate;
    return at.impact.encounter.closing_speed;
  }
};

}  // namespace

void add_closing_speed(const CaptureModel& model, ConstraintSet& out) {
  auto row = std::make_unique<ClosingSpeed>(model.problem.constraints.closing_speed_min);
  if (model.layout.time >= 0 && model.encounter.follows_target()) {
    out.rows.push_back(std::move(row));
  } else if (!model.encounter.magnitude_is_given()) {
    out.reported.push_back(std::move(row));
  }
}

}  // namespace stillbase
