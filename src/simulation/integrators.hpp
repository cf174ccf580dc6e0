// From one instant to another.
#pragma once

#include <memory>

#include "simulation/closed_loop.hpp"

namespace stillbase {

/// One classical Runge-Kutta step of the closed loop, attitude brought back to unit length. Does
/// not allocate.
void rk4_step(ClosedLoop& loop, double t, double h, StateVector& x, Recorder* recorder);
/// The same of the midpoint rule.
void midpoint_step(ClosedLoop& loop, double t, double h, StateVector& x, Recorder* recorder);

/// Takes the state from one instant to another, event by event.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// From t to t1. The recorder observes the beginning of every step, not t1 itself. On any status
  /// but Finished x is the last good state and t its time.
  SimulationStatus advance(ClosedLoop& loop, StateVector& x, double& t, double t1,
                           Recorder& recorder);
  long steps() const { return steps_; }
  /// @param steps that the run has had before
  void count_from(long steps) { steps_ = steps; }

 protected:
  explicit Integrator(const SimulationOptions& options) : options_(options) {}
  /// One accepted step, not beyond t1; on any status but Finished x and t stay.
  virtual SimulationStatus step(ClosedLoop& loop, StateVector& x, double& t, double t1,
                                Recorder& recorder) = 0;
  /// One step of exactly h, without error control: h is part of a step that was accepted.
  virtual void part_of_step(ClosedLoop& loop, double t, double h, StateVector& x) = 0;
  /// The derivative may have changed since the last step.
  virtual void restart() {}

  const SimulationOptions& options_;
  long steps_ = 0;  ///< tried so far

 private:
  void cut_at_event(ClosedLoop& loop, const StateVector& from, double t_from, StateVector& x,
                    double& t);
};

std::unique_ptr<Integrator> make_fixed_integrator(const SimulationOptions& options);
std::unique_ptr<Integrator> make_adaptive_integrator(const SimulationOptions& options);

/// Why to stop before the next step; Finished when there is no reason.
SimulationStatus check_stop(const SimulationOptions& options, long steps);

}  // namespace stillbase
