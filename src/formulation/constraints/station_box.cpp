// Base position within a box: the base stands where the hand is at its point.
#include "formulation/constraints/hand_point_kernel.hpp"

namespace stillbase {

namespace {

/// Component i in N of the base position that puts the hand on its point, m.
class StationBox final : public ConstraintOf<StationBox> {
 public:
  StationBox(int i, const VariableSpec& box)
      : ConstraintOf(std::string("base_position_") + kAxisNames[i], "m", box.base_position_lower[i],
                     box.base_position_upper[i]),
        i_(i) {}

  template <class S>
  S evaluate(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) const {
    if (gradient != nullptr) add_hand_point_gradient<S>(at, i_, S(-1), *gradient);
    const S from_base = at.placement.R_NB.row(i_).dot(at.posture.kinematics.r_bh);
    return wanted_hand_point<S>(at)[i_] - from_base;
  }

 private:
  int i_;
};

}  // namespace

void add_station_box(const CaptureModel& model, ConstraintSet& out) {
  const VariableSpec& variables = model.problem.variables;
  if (variables.base_position != PositionFreedom::Box || !has_hand_point(model)) return;
  for (int i = 0; i < 3; ++i) out.rows.push_back(std::make_unique<StationBox>(i, variables));
}

}  // namespace stillbase
