// One step of the simulation under control, and the whole of a trial's simulation.
#include "bench_support.hpp"

#include <stillbase/simulation/simulate.hpp>

#include "simulation/integrators.hpp"

namespace stillbase {

PlantState moving_arm() {
  Random random(5);
  PlantState state = state_at_rest(Pose{}, JointVectord::Zero(robot().n()));
  for (double& angle : state.phi) angle = random.uniform(-1, 1);
  for (double& rate : state.phidot) rate = random.uniform(-0.05, 0.05);
  state.Omega << 0.01, -0.02, 0.01, 0.01, 0.02, -0.01;
  return state;
}

namespace {

const JointVectord& rotors() {
  static const JointVectord inertia = JointVectord::Constant(robot().n(), 0.5);
  return inertia;
}

Controller rns_damped() {
  Controller controller;
  controller.kind = ControllerKind::RnsDamped;
  return controller;
}

/// One classical Runge-Kutta step, joints without torque.
void rk4_step_without_control(benchmark::State& state) {
  const SimulationOptions options;
  const Controller controller;
  const JointVectord no_rotors = JointVectord::Zero(robot().n());
  ClosedLoop loop(robot(), no_rotors, controller, options);
  const StateVector start = pack(moving_arm());
  StateVector x = start;
  int steps = 0;
  measure(state, [&] {
    if (++steps % 1000 == 0) x = start;
    rk4_step(loop, 0, kStep, x, nullptr);
    benchmark::DoNotOptimize(x);
  });
}
BENCHMARK(rk4_step_without_control);

/// The controller and one classical Runge-Kutta step; sampled control with hold, or evaluated at
/// each of the four stages.
void rk4_step_under_control(benchmark::State& state, double period) {
  SimulationOptions options;
  options.control_period = period;
  const Controller controller = rns_damped();
  ClosedLoop loop(robot(), rotors(), controller, options);
  const StateVector start = pack(moving_arm());
  StateVector x = start;
  int steps = 0;
  measure(state, [&] {
    if (++steps % 1000 == 0) x = start;
    loop.sample(0, x);
    rk4_step(loop, 0, kStep, x, nullptr);
    benchmark::DoNotOptimize(x);
  });
}
BENCHMARK_CAPTURE(rk4_step_under_control, sampled_rns_damped, 0.001);
BENCHMARK_CAPTURE(rk4_step_under_control, continuous_rns_damped, 0.0);

/// Ten seconds under sampled control, of a single run.
void ten_seconds(benchmark::State& state, double period) {
  JointResistance resistance;
  resistance.model = ResistanceModel::RotorInertia;
  resistance.rotor_inertia = rotors();
  SimulationOptions options;
  options.control_period = options.step = period;
  options.output_period = 0;
  const PlantState start = moving_arm();
  measure(state, [&] {
    benchmark::DoNotOptimize(
        simulate_post_impact(robot(), resistance, start, rns_damped(), options));
  });
}
BENCHMARK_CAPTURE(ten_seconds, control_1ms, 0.001)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ten_seconds, control_10ms, 0.01)->Unit(benchmark::kMillisecond);

/// The same of as many runs as this processor simulates side by side; the time is that of all.
/// Joints have no stops: a run that meets one goes on alone.
void ten_seconds_side_by_side(benchmark::State& state, double period) {
  PostImpactRun run{robot(), {}, moving_arm(), {}};
  for (Joint& joint : run.robot.joints) {
    joint.lower = -kInfinity;
    joint.upper = kInfinity;
  }
  run.resistance.model = ResistanceModel::RotorInertia;
  run.resistance.rotor_inertia = rotors();
  run.options.control_period = run.options.step = period;
  run.options.output_period = 0;
  const int lanes = size_of_group(1000, 1);
  const std::vector<PostImpactRun> runs(static_cast<std::size_t>(lanes), run);
  measure(state, [&] { benchmark::DoNotOptimize(simulate_post_impacts(runs, rns_damped())); });
  state.counters["runs"] = lanes;
}
BENCHMARK_CAPTURE(ten_seconds_side_by_side, control_1ms, 0.001)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ten_seconds_side_by_side, control_10ms, 0.01)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace stillbase
