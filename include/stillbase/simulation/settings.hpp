// A problem's `post_impact` section as controller and plant. Templates, because this room knows no
// problem; Spec is PostImpactSpec of <stillbase/plan/problem.hpp>.
#pragma once

#include <stillbase/simulation/simulate.hpp>

namespace stillbase {

template <class Spec>
Controller controller_of(ControllerKind kind, const Spec& spec) {
  Controller controller;
  controller.kind = kind;
  controller.K_omega = spec.K_omega;
  controller.K_phi = spec.K_phi;
  controller.handback_start = spec.handback_start;
  controller.K_handback = spec.handback_gain;
  return controller;
}

/// Control period, horizon, friction, stops and wheels; all else as SimulationOptions has it.
template <class Spec>
SimulationOptions plant_options_of(const Spec& spec) {
  SimulationOptions options;
  options.control_period = spec.control_period;
  options.horizon = spec.horizon;
  options.friction = spec.joint_friction;
  options.stop_restitution = spec.stop_restitution;
  options.wheels = {spec.wheel_torque, spec.wheel_momentum};
  return options;
}

}  // namespace stillbase
