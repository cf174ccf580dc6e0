// Motion of the robot under control laws, integrated a second time: dense equations of motion of
// `reference`, switches of friction, stops and contact, and an integrator of its own. Shares
// nothing with `simulation` but the robot model.
#pragma once

#include <vector>

#include <stillbase/core/interrupt.hpp>

#include "reference/control_laws.hpp"

namespace stillbase::reference {

struct ControlledMotion {
  std::vector<Motion> samples;            ///< at the instants asked for
  Eigen::VectorXd peak_demanded_torques;  ///< n, max |tau_k| over the commands, before limits
  Eigen::Vector3d peak_wheel_torques = Eigen::Vector3d::Zero();  ///< max |u_i| over the commands
  bool complete = false;  ///< false: stopped, or the step fell below rounding
  bool has_two_at_stops =
      false;  ///< and ended there: the law of one impulse does not tell the rest
};

/// Integrates from `start` at time 0 by Dormand and Prince's method 5(4), with steps that end at
/// every command, sample and switch. Torques are cut at max_effort; a joint at its max_velocity or
/// beyond gets none in that direction.
///
/// Switches are located by bisection down to rounding. A joint with Coulomb friction that comes to
/// rest stays there until starting_directions() says otherwise. A joint that reaches its stop has
/// its rate reversed, times `stop_restitution`, by an impulse that leaves every momentum; it moves
/// joints at rest as well, but where it is slower than `least_rebound`.
/// @param times of the samples, s, ascending, the first one 0
/// @param tolerance of a step: error over 1 + |state|, in SI units
/// @pre `sensors` only with a period
ControlledMotion controlled_motion(const ControlledRobot& subject, const ControlLaw& law,
                                   const Motion& start, const std::vector<double>& times,
                                   double tolerance, const StopCondition& stop);

}  // namespace stillbase::reference
