// Base position within a box: the base stands where the hand is at its point.
#include "formulation/constraints/hand_point_kernel.hpp"

namespace stillbase {

void add_station_box(const CaptureModel& model, ConstraintSet& out) {
  const VariableSpec& variables = model.problem.variables;
  if (variables.base_position != PositionFreedom::Box || !has_hand_point(model)) return;
  for (int i = 0; i < 3; ++i) {
    // Component i in N of the base position that puts the hand on its point.
    add_constraint(out.rows,
                   {std::string("base_position_") + kAxisNames[i], "m",
                    variables.base_position_lower[i], variables.base_position_upper[i]},
                   [i]<class S>(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) -> S {
                     if (gradient != nullptr) add_hand_point_gradient<S>(at, i, S(-1), *gradient);
                     const S from_base = at.placement.R_NB.row(i).dot(at.posture.kinematics.r_bh);
                     return wanted_hand_point<S>(at)[i] - from_base;
                   });
  }
}

}  // namespace stillbase
