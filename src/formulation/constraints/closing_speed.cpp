// Closing speed of hand and target along the nominal direction.
#include "formulation/constraints/constraint.hpp"

namespace stillbase {

void add_closing_speed(const CaptureModel& model, ConstraintSet& out) {
  const bool varies = model.layout.time >= 0 && model.encounter.follows_target();
  if (!varies && model.encounter.magnitude_is_given()) return;
  const double least = model.problem.constraints.closing_speed_min;
  ConstraintLabel label{.name = "closing_speed",
                        .unit = "m/s",
                        .lower = least,
                        .upper = kInfinity,
                        .needs_encounter = true};
  label.is_always_reported = true;  // the target need not rotate
  add_constraint(varies ? out.rows : out.reported, label,
                 []<class S>(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) -> S {
                   if (gradient != nullptr) gradient->t = at.impact.closing_speed_rate;
                   return at.impact.encounter.closing_speed;
                 });
}

}  // namespace stillbase
