#include "simulation/integrators.hpp"

#include <limits>

namespace stillbase {

SimulationStatus Integrator::advance(ClosedLoop& loop, StateVector& x, double& t, double t1,
                                     StepObserver& observer) {
  restart();
  if (!loop.handle_events(t, x, observer)) return SimulationStatus::StepLimit;
  while (t < t1) {
    const StateVector from = x;
    const double t_from = t;
    const SimulationStatus status = step(loop, x, t, t1, observer);
    if (status != SimulationStatus::Finished) return status;
    if (!loop.has_event(t, x)) continue;
    cut_at_event(loop, from, t_from, x, t);
    if (!loop.handle_events(t, x, observer)) return SimulationStatus::StepLimit;
    restart();
    if (loop.is_over()) return SimulationStatus::Finished;
  }
  return SimulationStatus::Finished;
}

/// The step is shortened to the first instant after its event, by bisection down to rounding.
void Integrator::cut_at_event(ClosedLoop& loop, const StateVector& from, double t_from,
                              StateVector& x, double& t) {
  double low = 0, high = t - t_from;
  const double resolution =
      4 * std::numeric_limits<double>::epsilon() * std::max(1.0, std::abs(t_from));
  StateVector at_high = x;
  while (high - low > resolution) {
    const double h = 0.5 * (low + high);
    StateVector y = from;
    part_of_step(loop, t_from, h, y);
    if (loop.has_event(t_from + h, y)) {
      high = h;
      at_high = y;
    } else {
      low = h;
    }
  }
  x = at_high;
  t = t_from + high;
}

}  // namespace stillbase
