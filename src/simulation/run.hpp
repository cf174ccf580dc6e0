// Shared by the runs with and without a target.
#pragma once

#include "simulation/integrators.hpp"
#include "simulation/recorder.hpp"

namespace stillbase {

/// Refuses what cannot be run, everything at once.
/// @throws InputError
void check_simulation(const RobotModel& robot, const JointResistance& resistance,
                      const PlantState& initial, const Controller& controller,
                      const SimulationOptions& options);

/// From x at options.start_time over the horizon; x and t end where the run ended.
SimulationResult run_loop(ClosedLoop& loop, StateVector& x, double& t, const RobotModel& robot,
                          const Controller& controller, const SimulationOptions& options);

}  // namespace stillbase
