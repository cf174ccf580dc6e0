// Motions by the simulation and by `reference`, side by side.
#pragma once

#include <algorithm>

#include <stillbase/simulation/simulate.hpp>

#include "reference/controlled_motion.hpp"

namespace stillbase::verification_test {

inline SimulationOptions precise(double horizon, double period) {
  SimulationOptions options;
  options.integrator = IntegratorKind::Fehlberg78;
  options.relative_tolerance = 1e-12;
  options.absolute_tolerance = 1e-13;
  options.horizon = horizon;
  options.output_period = horizon / 4;
  options.control_period = period;
  return options;
}

/// Largest difference of the states at the samples.
inline double apart(const std::vector<TraceSample>& trace, const reference::ControlledMotion& own) {
  double most = own.samples.size() == trace.size() ? 0 : kInfinity;
  for (std::size_t i = 0; i < std::min(trace.size(), own.samples.size()); ++i) {
    const reference::State& state = own.samples[i].state;
    most = std::max({most, (trace[i].state.Omega - state.Omega).norm(),
                     (trace[i].state.phidot - state.phidot).norm(),
                     (trace[i].state.phi - state.phi).norm(),
                     (trace[i].state.wheel_momentum - own.samples[i].wheel_momentum).norm()});
    if (!trace[i].target || !own.samples[i].target) continue;
    const reference::BodyMotion& target = *own.samples[i].target;
    most = std::max({most, (trace[i].target->velocity - target.velocity).norm(),
                     (trace[i].target->angular_velocity - target.rate).norm(),
                     (trace[i].target->pose.position - target.pose.position).norm()});
  }
  return most;
}

/// Instants of the samples, from the first one on.
inline std::vector<double> times_of(const std::vector<TraceSample>& trace) {
  std::vector<double> times;
  for (const TraceSample& sample : trace) times.push_back(sample.time - trace.front().time);
  return times;
}

}  // namespace stillbase::verification_test
