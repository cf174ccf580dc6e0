// Measurement of the state: some control periods old, with errors.
#pragma once

#include <deque>

#include <stillbase/core/random.hpp>
#include <stillbase/simulation/simulate.hpp>

namespace stillbase {

class Sensing {
 public:
  /// @param control_period s, > 0 unless the sensors are exact
  Sensing(const Sensors& sensors, double control_period);
  bool is_exact() const { return is_exact_; }
  /// The measurement that is at hand at a control instant. Before the first delayed one arrives it
  /// is the first one.
  PlantState measure(const PlantState& state);

 private:
  Sensors sensors_;
  bool is_exact_;
  std::size_t delay_;  ///< control periods
  Random random_;
  std::deque<PlantState> on_the_way_;
};

}  // namespace stillbase
