#include <algorithm>
#include <cmath>

#include "simulation/integrators.hpp"

namespace stillbase {
namespace {

class Rk4Integrator final : public Integrator {
 public:
  explicit Rk4Integrator(const SimulationOptions& options) : options_(options) {}

  SimulationStatus advance(ClosedLoop& loop, StateVector& x, double& t, double t1,
                           StepObserver& observer) override {
    // The allowance keeps rounding of the interval from making two steps of one.
    const double t0 = t;
    const double count = std::max(1.0, std::ceil((t1 - t0) / options_.step - 1e-6));
    const double h = (t1 - t0) / count;
    for (double i = 0; i < count; ++i) {
      const SimulationStatus status = check_stop(options_, steps_);
      if (status != SimulationStatus::Finished) return status;
      const StateVector before = x;
      rk4_step(loop, t, h, x, &observer);
      ++steps_;
      if (!is_bounded(x)) {
        x = before;
        return SimulationStatus::Diverged;
      }
      t = i + 1 < count ? t0 + (i + 1) * h : t1;
    }
    return SimulationStatus::Finished;
  }

 private:
  const SimulationOptions& options_;
};

}  // namespace

void rk4_step(ClosedLoop& loop, double t, double h, StateVector& x, StepObserver* observer) {
  StateVector k1, k2, k3, k4;
  StateVector y = x;
  loop.derivative(t, y, k1, observer);
  y = x + 0.5 * h * k1;
  loop.derivative(t + 0.5 * h, y, k2, nullptr);
  y = x + 0.5 * h * k2;
  loop.derivative(t + 0.5 * h, y, k3, nullptr);
  y = x + h * k3;
  loop.derivative(t + h, y, k4, nullptr);
  x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  normalise_attitude(x);
}

std::unique_ptr<Integrator> make_rk4_integrator(const SimulationOptions& options) {
  return std::make_unique<Rk4Integrator>(options);
}

SimulationStatus check_stop(const SimulationOptions& options, long steps) {
  if (options.stop.is_interrupted()) return SimulationStatus::Interrupted;
  if (options.stop.is_late()) return SimulationStatus::TimeLimit;
  if (steps >= options.max_steps) return SimulationStatus::StepLimit;
  return SimulationStatus::Finished;
}

}  // namespace stillbase
