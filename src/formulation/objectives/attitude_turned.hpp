// The rotation of the base some time after the impact: the one quantity of an objective that takes
// a simulation.
//
// Runge and Kutta's method of order 4 with a fixed step makes the rotation a smooth function of the
// posture while no joint reaches its stop and no drive its limit. Adaptive steps would add jumps of
// the size of their tolerance, too large for differences.
#pragma once

#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/problem.hpp>
#include <stillbase/simulation/simulate.hpp>

namespace stillbase {

class AttitudeTurned {
 public:
  /// @throws InputError when the problem names no controller or the term no time
  AttitudeTurned(const CaptureProblem& problem, const ObjectiveTerm& term);

  /// Rotation vector from the base's attitude at the impact to that `after` seconds later, in the
  /// axes of the base at the impact, rad over the term's size. Its length is at most pi: a full
  /// rotation counts as none. A simulation that breaks off counts as pi.
  /// @param phi posture at the impact, n
  /// @param Delta_Omega, Delta_phidot the jump of base and joints, from rest
  /// @param stop from then on the simulation is given up, and the result is NaN
  Vector3d operator()(const JointVectord& phi, const Vector6d& Delta_Omega,
                      const JointVectord& Delta_phidot, const StopCondition& stop) const;

 private:
  RobotModel robot_;
  JointResistance resistance_;
  Controller controller_;
  SimulationOptions options_;
  double size_;
};

/// One for each simulated term of the problem's objective.
std::vector<AttitudeTurned> simulated_terms(const CaptureProblem& problem);

}  // namespace stillbase
