// The turn of the base some time after the impact: the one quantity of an objective that takes a
// simulation.
//
// Runge and Kutta's method of order 4 with a fixed step makes the turn a smooth function of the
// posture for as long as no joint meets its stop and no drive its limit; adaptive steps would put
// jumps of the size of their tolerance into it, and differences need better.
#pragma once

#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/problem.hpp>
#include <stillbase/simulation/simulate.hpp>

namespace stillbase {

class TurnAfterImpact {
 public:
  /// @throws InputError when the problem names no controller or the term no time
  TurnAfterImpact(const CaptureProblem& problem, const ObjectiveTerm& term);

  /// Rotation vector from the base's attitude at the impact to that `after` seconds later, in the
  /// axes of the base at the impact, rad over the term's size. Its length is at most pi: a whole
  /// turn is none. A simulation that breaks off counts as pi.
  /// @param phi posture in which the arm is hit, n
  /// @param Delta_Omega, Delta_phidot the jump of base and joints, from rest
  /// @param stop from then on the simulation is given up, and the turn is NaN
  Vector3d operator()(const JointVectord& phi, const Vector6d& Delta_Omega,
                      const JointVectord& Delta_phidot, const StopCondition& stop) const;

 private:
  RobotModel robot_;
  JointResistance resistance_;
  Controller controller_;
  SimulationOptions options_;
  double size_;
};

/// One for each attitude_turned of the problem's objective.
std::vector<TurnAfterImpact> turns_after_impact(const CaptureProblem& problem);

}  // namespace stillbase
