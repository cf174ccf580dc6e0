// A problem's `post_impact` section as controller and plant. Templates, because this room knows no
// problem; Spec is PostImpactSpec of <stillbase/plan/problem.hpp>.
#pragma once

#include <stillbase/simulation/after_contact.hpp>

namespace stillbase {

template <class Spec>
Controller controller_of(ControllerKind kind, const Spec& spec) {
  Controller controller;
  controller.kind = kind;
  controller.K_omega = spec.K_omega;
  controller.K_phi = spec.K_phi;
  controller.handback_start = spec.handback_start;
  controller.K_handback = spec.handback_gain;
  controller.friction_compensation = spec.model.friction_scale > 0;
  return controller;
}

/// The controller's model of a robot; empty: the robot itself.
template <class Spec>
std::optional<RobotModel> controller_robot_of(const Spec& spec, const RobotModel& robot) {
  const auto& model = spec.model;
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

/// Control period, horizon, friction, stops, wheels, thrusters, sensors and the controller's model;
/// all else as SimulationOptions has it.
template <class Spec>
SimulationOptions plant_options_of(const Spec& spec, const RobotModel& robot) {
  SimulationOptions options;
  options.control_period = spec.control_period;
  options.horizon = spec.horizon;
  options.friction = spec.joint_friction;
  options.stop_restitution = spec.stop_restitution;
  options.wheels = {spec.wheel_torque, spec.wheel_momentum};
  options.thrusters = {spec.thrusters.torque, spec.thrusters.gain, spec.thrusters.dead_band};
  options.sensors.base_rate_error = spec.sensor.base_rate_error;
  options.sensors.joint_position_error = spec.sensor.joint_position_error;
  options.sensors.joint_rate_error = spec.sensor.joint_rate_error;
  options.sensors.delay = spec.sensor.delay;
  options.sensors.seed = spec.sensor.seed;
  options.controller_robot = controller_robot_of(spec, robot);
  return options;
}

template <class Spec>
ContactChoice contact_choice_of(const Spec& spec) {
  return {spec.contact.model, spec.contact.stiffness, spec.contact.damping, spec.contact.friction,
          spec.model.target_mass_scale};
}

}  // namespace stillbase
