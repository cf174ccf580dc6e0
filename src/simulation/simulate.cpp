#include <stillbase/simulation/simulate.hpp>

#include <algorithm>
#include <cmath>
#include <stillbase/core/error.hpp>
#include <utility>

#include "simulation/integrators.hpp"

namespace stillbase {

namespace {

/// The controller's model of a robot; empty: the robot itself.
std::optional<RobotModel> controller_robot_of(const ControllerModelSpec& model,
                                              const RobotModel& robot) {
  const bool knows_friction = model.friction_scale == 0 || model.friction_scale == 1;
  if (model.base_mass_scale == 1 && model.arm_mass_scale == 1 && knows_friction) return {};
  RobotModel known = robot;
  const auto scale = [](Body& body, double factor) {
    body.mass *= factor;
    body.inertia *= factor;
  };
  scale(known.base, model.base_mass_scale);
  for (Body& body : known.bodies) scale(body, model.arm_mass_scale);
  for (Joint& joint : known.joints) {
    joint.viscous_friction *= model.friction_scale;
    joint.coulomb_friction *= model.friction_scale;
  }
  return known;
}

}  // namespace

SimulationOptions plant_options_of(const PostImpactSpec& spec, const RobotModel& robot) {
  SimulationOptions options;
  options.control_period = spec.control_period;
  options.horizon = spec.horizon;
  options.friction = spec.joint_friction;
  options.stop_restitution = spec.stop_restitution;
  options.wheels = spec.wheels;
  options.thrusters = spec.thrusters;
  options.grasp.limits = spec.grip;
  options.sensors = spec.sensor;
  options.controller_robot = controller_robot_of(spec.model, robot);
  return options;
}

void check_simulation(const RobotModel& robot, const JointResistance& resistance,
                      const PlantState& initial, const Controller& controller,
                      const SimulationOptions& options) {
  std::vector<Finding> findings;
  const auto require = [&](bool holds, const char* rule, const char* message) {
    if (!holds) findings.push_back({"simulation", 0, rule, message});
  };
  // !(x > 0) refuses NaN too.
  const auto is_size = [](double x) { return x >= 0 && std::isfinite(x); };
  const int n = robot.n();
  const bool sizes = initial.phi.size() == n && initial.phidot.size() == n;
  require(sizes, "state-size", "joint positions and rates need one number per joint");
  require(initial.phi.allFinite() && initial.phidot.allFinite() && initial.Omega.allFinite() &&
              initial.base.position.allFinite() && initial.base.orientation.coeffs().allFinite(),
          "state-finite", "the initial state must be finite");
  require(std::abs(initial.base.orientation.norm() - 1) < 1e-6, "state-attitude",
          "the base orientation must be a unit quaternion");
  require(resistance.model != ResistanceModel::RotorInertia || resistance.rotor_inertia.size() == n,
          "rotor-inertia", "rotor inertia needs one number per joint");
  require(is_size(controller.K_omega) && is_size(controller.K_phi), "gain",
          "gains must be finite and not negative");
  require(controller.rank_edge > 1e-7 && controller.rank_edge < 1, "rank-edge",
          "must lie between 1e-7 and 1");
  require(controller.joint_rate_edge > 0, "joint-rate-edge", "must be above zero");
  require(options.step > 0 && std::isfinite(options.step), "step", "must be finite and above zero");
  require(options.relative_tolerance > 0 && options.absolute_tolerance > 0, "tolerance",
          "must be above zero");
  require(is_size(options.control_period), "control-period", "must be finite and not negative");
  require(is_size(options.output_period), "output-period", "must be finite and not negative");
  require(is_size(options.horizon) && std::isfinite(options.start_time), "horizon",
          "must be finite and not negative");
  require(controller.friction_transition_rate > 0, "friction-transition-rate",
          "must be above zero");
  require(is_size(controller.K_handback) && controller.handback_start >= 0, "handback",
          "gain and start must be finite and not negative");
  require(options.stop_restitution >= 0 && options.stop_restitution < 1, "stop-restitution",
          "must lie in [0, 1)");
  const WheelSpec& wheels = options.wheels;
  require(wheels.torque.allFinite() && (wheels.torque.array() >= 0).all() &&
              (wheels.momentum.array() >= 0).all(),
          "wheels", "torque and momentum must be numbers, not negative");
  const GripSpec& grip = options.grasp.limits;
  require(grip.force.value_or(1) > 0 && grip.moment.value_or(1) > 0, "grip",
          "force and moment must be numbers above zero");
  require(is_size(controller.K_detumble) && controller.reserve >= 0 && controller.reserve < 1,
          "detumble", "the gain must be finite and not negative, the reserve in [0, 1)");
  const ThrusterSpec& thrusters = options.thrusters;
  require(is_size(thrusters.torque) && is_size(thrusters.gain) && thrusters.dead_band >= 0,
          "thrusters", "torque, gain and dead band must be numbers, not negative");
  const SensorSpec& sensors = options.sensors;
  require(sensors.base_rate_error >= 0 && sensors.joint_position_error >= 0 &&
              sensors.joint_rate_error >= 0 && is_size(sensors.delay),
          "sensors", "errors and delay must be finite and not negative");
  const double periods = sensors.delay / options.control_period;
  require(sensors.are_exact() || options.control_period > 0, "sensors",
          "errors and delay need sampled control");
  require(!(sensors.delay > 0) || std::abs(periods - std::round(periods)) < 1e-6, "sensor-delay",
          "must be a whole number of control periods");
  require(!options.controller_robot || options.controller_robot->n() == n, "controller-robot",
          "must have the robot's joints");
  if (!findings.empty()) throw InputError(std::move(findings));
}

std::string to_string(SimulationStatus status) {
  constexpr const char* kNames[] = {"finished", "interrupted", "time_limit", "step_limit",
                                    "diverged"};
  return kNames[static_cast<int>(status)];
}

std::string to_string(LimitKind kind) {
  constexpr const char* kNames[] = {"torque", "rate", "lower_stop", "upper_stop"};
  return kNames[static_cast<int>(kind)];
}

SimulationResult run_on(ClosedLoop& loop, StateVector& x, double& t, Course& course,
                        const SimulationOptions& options) {
  Recorder& recorder = course.recorder;
  const bool is_adaptive = options.integrator == IntegratorKind::Dopri5 ||
                           options.integrator == IntegratorKind::Fehlberg78;
  const std::unique_ptr<Integrator> integrator =
      is_adaptive ? make_adaptive_integrator(options) : make_fixed_integrator(options);
  const double end = options.start_time + options.horizon;
  SimulationStatus status = SimulationStatus::Finished;
  integrator->count_from(course.steps);
  const auto is_over = [&] {
    if (std::exchange(course.is_within_stretch, false)) return false;
    return loop.is_over() || (options.ends_when && options.ends_when(recorder.so_far()));
  };
  while (t < end && status == SimulationStatus::Finished && !is_over()) {
    if (course.control.fires_at(t)) loop.sample(t, x);
    if (course.output.fires_at(t)) recorder.record_next();
    const double next =
        end_of_stretch(t, std::min(course.control.next(), course.output.next()), end);
    status = integrator->advance(loop, x, t, next, recorder);
  }
  // The last state, after any end of the run.
  recorder.record_next();
  StateVector unused;
  loop.derivative(t, x, unused, &recorder);
  return recorder.take(status, integrator->steps());
}

SimulationResult run_loop(ClosedLoop& loop, StateVector& x, double& t, const RobotModel& robot,
                          const Controller& controller, const SimulationOptions& options) {
  Course course(robot, controller, options);
  normalise_attitude(x, loop.n());
  t = options.start_time;
  return run_on(loop, x, t, course, options);
}

SimulationResult simulate_post_impact(const RobotModel& robot, const JointResistance& resistance,
                                      const PlantState& initial, const Controller& controller,
                                      const SimulationOptions& options) {
  check_simulation(robot, resistance, initial, controller, options);
  const JointVectord rotor_inertia = added_plant_inertia(resistance, robot.n());
  ClosedLoop loop(robot, rotor_inertia, controller, options);
  StateVector x = pack(initial);
  double t = 0;
  return run_loop(loop, x, t, robot, controller, options);
}

SimulationResult simulate_impact(const RobotModel& robot, const JointResistance& resistance,
                                 const PlantState& before, const Vector6d& Fbar, double lead_time,
                                 const Controller& controller, const SimulationOptions& options) {
  SimulationOptions lead = options;
  lead.horizon = lead_time;
  SimulationResult first = simulate_post_impact(robot, resistance, before, controller, lead);
  if (first.status != SimulationStatus::Finished) return first;

  SimulationOptions after_impact = options;
  after_impact.start_time = options.start_time + lead_time;
  const PlantState after = state_after_impact(robot, resistance, first.trace.back().state, Fbar);
  SimulationResult second =
      simulate_post_impact(robot, resistance, after, controller, after_impact);
  second.trace.insert(second.trace.begin(), first.trace.begin(), first.trace.end());
  return second;
}

}  // namespace stillbase
