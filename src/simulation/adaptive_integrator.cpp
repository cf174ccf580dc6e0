// The only file that uses Boost.odeint.
#include <algorithm>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "simulation/integrators.hpp"

namespace stillbase {
namespace {

namespace odeint = boost::numeric::odeint;
using Numbers = std::vector<double>;

/// @tparam Plain the stepper, @tparam Controlled the same with error control
template <class Plain, class Controlled>
class AdaptiveIntegrator final : public Integrator {
 public:
  AdaptiveIntegrator(Controlled stepper, const SimulationOptions& options)
      : Integrator(options), stepper_(std::move(stepper)), step_(options.step) {}

 protected:
  SimulationStatus step(ClosedLoop& loop, StateVector& x, double& t, double t1,
                        Recorder& recorder) override {
    loop.derivative(t, x, dydt_, &recorder);
    numbers_.assign(x.data(), x.data() + x.size());
    const SimulationStatus status = one_step(system(loop), t, t1);
    if (status == SimulationStatus::Finished) take(numbers_, x, loop);
    return status;
  }

  void part_of_step(ClosedLoop& loop, double t, double h, StateVector& x) override {
    Plain stepper;  // a fresh one carries no derivative over
    Numbers numbers(x.data(), x.data() + x.size());
    stepper.do_step(system(loop), numbers, t, h);
    take(numbers, x, loop);
  }

  void restart() override {
    if constexpr (requires { stepper_.reset(); }) stepper_.reset();
  }

 private:
  auto system(ClosedLoop& loop) {
    return [this, &loop](const Numbers& from, Numbers& to, double time) {
      y_ = Eigen::Map<const Eigen::VectorXd>(from.data(), static_cast<Eigen::Index>(from.size()));
      loop.derivative(time, y_, dydt_, nullptr);
      std::copy(dydt_.data(), dydt_.data() + dydt_.size(), to.begin());
    };
  }

  static void take(const Numbers& from, StateVector& x, const ClosedLoop& loop) {
    x = Eigen::Map<const Eigen::VectorXd>(from.data(), x.size());
    normalise_attitude(x, loop.n());
  }

  /// One accepted step, not beyond t1. numbers_ and t move only with an accepted step.
  template <class System>
  SimulationStatus one_step(const System& system, double& t, double t1) {
    const Numbers before = numbers_;
    for (;;) {
      const SimulationStatus status = check_stop(options_, steps_);
      if (status != SimulationStatus::Finished) return status;
      const bool last = t + step_ >= t1;
      double dt = last ? t1 - t : step_;
      if (dt <= 16 * std::numeric_limits<double>::epsilon() * std::abs(t) && !last) {
        return SimulationStatus::StepLimit;
      }
      const double t_before = t;
      ++steps_;
      const bool accepted = stepper_.try_step(system, numbers_, t, dt) == odeint::success;
      // A step cut short by t1 does not predict the next one: keep the longer proposal.
      step_ = accepted && last ? std::max(step_, dt) : dt;
      const Eigen::Map<const Eigen::VectorXd> reached(numbers_.data(),
                                                      static_cast<Eigen::Index>(numbers_.size()));
      if (!is_bounded(reached) || !std::isfinite(step_)) {
        // odeint takes an error of NaN for a small one.
        numbers_ = before;
        t = t_before;
        return SimulationStatus::Diverged;
      }
      if (!accepted) continue;
      if (last) t = t1;
      return SimulationStatus::Finished;
    }
  }

  Controlled stepper_;
  double step_;  ///< s, proposal for the next step
  Numbers numbers_;
  StateVector y_, dydt_;
};

template <class Stepper>
std::unique_ptr<Integrator> make(const SimulationOptions& options) {
  auto controlled =
      odeint::make_controlled(options.absolute_tolerance, options.relative_tolerance, Stepper());
  return std::make_unique<AdaptiveIntegrator<Stepper, decltype(controlled)>>(controlled, options);
}

}  // namespace

std::unique_ptr<Integrator> make_adaptive_integrator(const SimulationOptions& options) {
  return options.integrator == IntegratorKind::Dopri5
             ? make<odeint::runge_kutta_dopri5<Numbers>>(options)
             : make<odeint::runge_kutta_fehlberg78<Numbers>>(options);
}

}  // namespace stillbase
