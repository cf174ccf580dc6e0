// The box of all values of the variables.
#pragma once

#include "proof/enclose.hpp"
#include "proof/encounter_kernel.hpp"

namespace stillbase::proof {

/// @param periodic which of them are angles with a range of 360 deg
/// @pre N >= encounter.num_variables(); sides beyond are zero
template <int N>
Box<N> domain_of(const RobotModel& robot, const VariableEncounter& encounter,
                 std::array<bool, N>& periodic) {
  const Interval whole_turn(-kPi.upper(), kPi.upper());
  Box<N> box;
  periodic.fill(false);
  for (std::size_t i = 0; i < encounter.free.size(); ++i) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(encounter.free[i])];
    periodic[i] = joint.type == JointType::Continuous;
    box.side[i] = periodic[i] ? whole_turn : Interval(encounter.lower[i], encounter.upper[i]);
  }
  if (encounter.attitude_is_free) {
    const auto i = static_cast<std::size_t>(encounter.attitude_index());
    periodic[i] = encounter.attitude_max >= kPi.lower();
    box.side[i] =
        periodic[i] ? whole_turn : Interval(-encounter.attitude_max, encounter.attitude_max);
  }
  for (std::size_t i = 0; i < encounter.turn_basis.size(); ++i) {
    box[encounter.attitude_index() + static_cast<int>(i)] =
        Interval(-encounter.turn_size_max, encounter.turn_size_max);
  }
  if (encounter.time_is_free) {
    box[encounter.time_index()] = Interval(encounter.time_lower / encounter.time_unit,
                                           encounter.time_upper / encounter.time_unit);
  }
  return box;
}

}  // namespace stillbase::proof
