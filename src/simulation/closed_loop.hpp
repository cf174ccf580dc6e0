// Plant and controller as one ordinary differential equation.
#pragma once

#include <stillbase/simulation/simulate.hpp>

namespace stillbase {

/// [position (3), quaternion xyzw (4), phi (n), Omega (6), phidot (n)].
using StateVector =
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 13 + 2 * kMaxJoints, 1>;

StateVector pack(const PlantState& state);
/// The quaternion comes out with unit length.
PlantState unpack(const StateVector& x);
/// Brings the quaternion of a state vector to unit length.
void normalise_attitude(StateVector& x);
/// Finite, and not so large that products of its elements would leave the range of numbers.
bool is_bounded(const StateVector& x);

/// Gets to see every step: state, terms of (3) and applied torque (n) at its beginning.
class StepObserver {
 public:
  virtual ~StepObserver() = default;
  virtual void observe(double t, const PlantState& state, const PlantTerms& terms,
                       const JointVectord& tau, bool saturated) = 0;
};

class ClosedLoop {
 public:
  /// The references must outlive the loop.
  ClosedLoop(const RobotModel& robot, const JointVectord& rotor_inertia,
             const Controller& controller, const SimulationOptions& options);

  /// Sampled control: the next evaluation of the derivative is a control instant.
  void sample_next() { sample_now_ = true; }

  /// @param observer may be null
  void derivative(double t, const StateVector& x, StateVector& dxdt, StepObserver* observer);

 private:
  JointVectord limited(const JointVectord& tau, bool& saturated) const;

  const RobotModel& robot_;
  const JointVectord& rotor_inertia_;
  const Controller& controller_;
  const SimulationOptions& options_;
  bool sample_now_ = true;
  bool held_saturated_ = false;
  JointVectord held_;  ///< n, torque between control instants
};

}  // namespace stillbase
