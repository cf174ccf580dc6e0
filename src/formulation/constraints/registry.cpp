#include "formulation/constraints/constraint.hpp"

namespace stillbase {

using AddConstraints = void(const CaptureModel&, ConstraintSet&);

AddConstraints add_hand_position, add_station_box, add_hand_axis, add_hand_pose, add_case_total,
    add_case_base, add_case_coupling, add_joint_rate, add_arrival_rate, add_clearance,
    add_closing_speed, add_contact_push, add_attitude_cone, add_attitude_angle;

#define STILLBASE_LEAST_VALUE(quantity, dimension, uncounted, sentence) \
  AddConstraints add_##quantity;
STILLBASE_LEAST_VALUES(STILLBASE_LEAST_VALUE)
#undef STILLBASE_LEAST_VALUE
#define STILLBASE_LEAST_VALUE(quantity, dimension, uncounted, sentence) add_##quantity,

ConstraintSet constraints_of(const CaptureModel& model) {
  static constexpr AddConstraints* kConstraints[] = {
      add_hand_position,  // hand at the contact feature or at a stated point
      add_station_box,    // base position that puts it there within a box
      add_hand_axis,      // approach axis against the direction
      add_hand_pose,      // all three axes of the hand
      add_case_total,     // cases C, C1, C2: no angular momentum of the system
      add_case_base,      // case G2: none of the base
      add_case_coupling,  // cases G3, C2: no coupling angular momentum
      add_joint_rate,     // joint rates right after the impact
      add_arrival_rate,   // joint rates right before a contact with a hand that moves
      // clang-format off
      STILLBASE_LEAST_VALUES(STILLBASE_LEAST_VALUE)
      // clang-format on
      add_clearance,      // distances between bodies
      add_closing_speed,  // of hand and target
      add_contact_push,   // a sticking contact does not pull
      add_attitude_cone,  // base axis within its cone
      add_attitude_angle  // base attitude within an angle
  };
  ConstraintSet out;
  for (AddConstraints* const add : kConstraints) add(model, out);
  return out;
}

#undef STILLBASE_LEAST_VALUE

}  // namespace stillbase
