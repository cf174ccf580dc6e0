#include "simulation/integrators.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulation/ticks.hpp"

namespace stillbase {

SimulationStatus Integrator::advance(ClosedLoop& loop, StateVector& x, double& t, double t1,
                                     Recorder& recorder) {
  restart();
  if (!loop.handle_events(t, x, recorder)) return SimulationStatus::StepLimit;
  while (t < t1) {
    const StateVector from = x;
    const double t_from = t;
    const SimulationStatus status = step(loop, x, t, t1, recorder);
    if (status != SimulationStatus::Finished) return status;
    if (!loop.has_event(t, x)) continue;
    cut_at_event(loop, from, t_from, x, t);
    if (!loop.handle_events(t, x, recorder)) return SimulationStatus::StepLimit;
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

namespace {

class FixedIntegrator final : public Integrator {
 public:
  explicit FixedIntegrator(const SimulationOptions& options)
      : Integrator(options),
        step_(options.integrator == IntegratorKind::Midpoint ? midpoint_step : rk4_step) {}

 protected:
  SimulationStatus step(ClosedLoop& loop, StateVector& x, double& t, double t1,
                        Recorder& recorder) override {
    const SimulationStatus status = check_stop(options_, steps_);
    if (status != SimulationStatus::Finished) return status;
    const double count = number_of_steps(t, t1, options_.step);
    const double h = (t1 - t) / count;
    StateVector y = x;
    step_(loop, t, h, y, &recorder);
    ++steps_;
    if (!is_bounded(y)) return SimulationStatus::Diverged;
    x = y;
    t = count > 1 ? t + h : t1;
    return SimulationStatus::Finished;
  }
  void part_of_step(ClosedLoop& loop, double t, double h, StateVector& x) override {
    step_(loop, t, h, x, nullptr);
  }

 private:
  decltype(&rk4_step) step_;
};

}  // namespace

void rk4_step(ClosedLoop& loop, double t, double h, StateVector& x, Recorder* recorder) {
  StateVector k1, k2, k3, k4;
  StateVector y = x;
  loop.derivative(t, y, k1, recorder);
  y = x + 0.5 * h * k1;
  loop.derivative(t + 0.5 * h, y, k2, nullptr);
  y = x + 0.5 * h * k2;
  loop.derivative(t + 0.5 * h, y, k3, nullptr);
  y = x + h * k3;
  loop.derivative(t + h, y, k4, nullptr);
  x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  normalise_attitude(x, loop.n());
}

void midpoint_step(ClosedLoop& loop, double t, double h, StateVector& x, Recorder* recorder) {
  StateVector k1, k2;
  loop.derivative(t, x, k1, recorder);
  const StateVector y = x + 0.5 * h * k1;
  loop.derivative(t + 0.5 * h, y, k2, nullptr);
  x += h * k2;
  normalise_attitude(x, loop.n());
}

std::unique_ptr<Integrator> make_fixed_integrator(const SimulationOptions& options) {
  return std::make_unique<FixedIntegrator>(options);
}

SimulationStatus check_stop(const SimulationOptions& options, long steps) {
  if (options.stop.is_interrupted()) return SimulationStatus::Interrupted;
  if (options.stop.is_late()) return SimulationStatus::TimeLimit;
  if (steps >= options.max_steps) return SimulationStatus::StepLimit;
  return SimulationStatus::Finished;
}

}  // namespace stillbase
