// Boxes of the variables as boxes of the plan, and back.
#pragma once

#include <stillbase/plan/plan.hpp>

#include "proof/variable_encounter.hpp"

namespace stillbase::proof {

template <int N>
JointBox joint_box(const VariableEncounter& encounter, const Box<N>& box) {
  JointBox out{encounter.start, encounter.start, {}, {}};
  for (std::size_t i = 0; i < N; ++i) {
    const Variable& variable = encounter.variables[i];
    const double lower = box.side[i].lower(), upper = box.side[i].upper();
    if (variable.kind == VariableKind::Joint) {
      out.lower[variable.joint] = lower;
      out.upper[variable.joint] = upper;
    } else if (variable.kind == VariableKind::BaseAngle) {
      out.base_angle = Ends{lower, upper};
    } else if (variable.kind == VariableKind::Time) {
      out.contact_time = Ends{lower * encounter.time_unit, upper * encounter.time_unit};
    }
  }
  return out;
}

/// The values of a variable in a box of the plan.
inline Interval side_of(const Variable& variable, const JointBox& place, double time_unit) {
  switch (variable.kind) {
    case VariableKind::Joint:
      return Interval(place.lower[variable.joint], place.upper[variable.joint]);
    case VariableKind::BaseAngle:
      return Interval(place.base_angle.value().lower, place.base_angle.value().upper);
    case VariableKind::Time:
      return Interval(place.contact_time.value().lower, place.contact_time.value().upper) /
             Interval(time_unit);
    case VariableKind::BaseParameter:
      break;  // no boxes of the plan have them
  }
  return Interval(-1, 1);
}

}  // namespace stillbase::proof
