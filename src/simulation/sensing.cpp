#include "simulation/sensing.hpp"

#include <cmath>

namespace stillbase {

Sensing::Sensing(const Sensors& sensors, double control_period)
    : sensors_(sensors),
      is_exact_(sensors.are_exact()),
      delay_(is_exact_ ? 0 : static_cast<std::size_t>(std::lround(sensors.delay / control_period))),
      random_(sensors.seed, sensors.stream) {}

PlantState Sensing::measure(const PlantState& state) {
  PlantState measured = state;
  for (int i = 3; i < 6; ++i) measured.Omega[i] += sensors_.base_rate_error * random_.normal();
  for (Eigen::Index k = 0; k < state.phi.size(); ++k) {
    measured.phi[k] += sensors_.joint_position_error * random_.normal();
    measured.phidot[k] += sensors_.joint_rate_error * random_.normal();
  }
  on_the_way_.push_back(std::move(measured));
  if (on_the_way_.size() > delay_ + 1) on_the_way_.pop_front();
  return on_the_way_.front();
}

}  // namespace stillbase
