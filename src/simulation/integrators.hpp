// From one instant to another.
#pragma once

#include <memory>

#include "simulation/closed_loop.hpp"

namespace stillbase {

/// One classical Runge-Kutta step of the closed loop, attitude brought back to unit length. Does
/// not allocate.
void rk4_step(ClosedLoop& loop, double t, double h, StateVector& x, StepObserver* observer);

/// Takes the state from t0 to t1. The observer sees the beginning of every step, not t1 itself.
class Integrator {
 public:
  virtual ~Integrator() = default;
  /// On any status but Finished x is the last good state and t its time.
  virtual SimulationStatus advance(ClosedLoop& loop, StateVector& x, double& t, double t1,
                                   StepObserver& observer) = 0;
  long steps() const { return steps_; }

 protected:
  long steps_ = 0;  ///< tried so far
};

std::unique_ptr<Integrator> make_rk4_integrator(const SimulationOptions& options);
std::unique_ptr<Integrator> make_adaptive_integrator(const SimulationOptions& options);

/// Why to stop before the next step; Finished when there is no reason.
SimulationStatus check_stop(const SimulationOptions& options, long steps);

}  // namespace stillbase
