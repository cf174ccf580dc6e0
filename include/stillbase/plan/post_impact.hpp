// The phase after the impact as a problem states it: contact, controllers, sensors and actuators.
// Plain data that problems and simulations share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/types.hpp>
#include <stillbase/impact/contact.hpp>

namespace stillbase {

/// How the simulation resolves the contact of hand and target, whose law is the problem's.
struct ContactSpec {
  ContactModel model = ContactModel::Instantaneous;
  double stiffness = 1e5;         ///< Compliant: N/m
  std::optional<double> damping;  ///< Compliant: N s/m; empty: leaves the problem's restitution
  double friction = 0;            ///< Compliant: Coulomb coefficient
};

/// Measurement of the state. Errors are independent and normal, drawn at each control instant from
/// (seed, stream); sampled control only.
struct SensorSpec {
  double base_rate_error = 0;       ///< rad/s, standard deviation per axis
  double joint_position_error = 0;  ///< rad or m
  double joint_rate_error = 0;      ///< rad/s or m/s
  double delay = 0;                 ///< s, a whole number of control periods
  std::uint64_t seed = 1;
  std::uint64_t stream = 0;  ///< in no file
  bool are_exact() const {
    return base_rate_error <= 0 && joint_position_error <= 0 && joint_rate_error <= 0 && delay <= 0;
  }
};

/// The controller's model of the robot, relative to the robot.
struct ControllerModelSpec {
  double base_mass_scale = 1;    ///< on mass and inertia of the base
  double arm_mass_scale = 1;     ///< on mass and inertia of the arm's bodies
  double target_mass_scale = 1;  ///< after a latch: on those of the target; 0: it has none
  double friction_scale = 0;     ///< fraction of the robot file's joint friction to compensate
};

/// Capacity of wheels of which none is stated, N m s: from here on it is no limit.
inline constexpr double kAnyWheelMomentum = 1e6;

/// Reaction wheels of the base, one per axis of B. Off by default: the paper has none.
struct WheelSpec {
  Vector3d torque = Vector3d::Zero();  ///< N m per axis; 0: there is none
  /// Capacity: N m s per axis; a full wheel takes no more.
  Vector3d momentum = Vector3d::Constant(kInfinity);
  /// Momentum before the approach and the contact, in B, N m s: put in by torques from outside on
  /// the robot at rest, so it is the total momentum of robot and wheels then. No approach of a
  /// floating base is planned with it, for the base turns, and it would turn the base further.
  Vector3d preset = Vector3d::Zero();
  bool exist() const { return (torque.array() > 0).any(); }
  /// Whether one number says torque, one says capacity, and nothing is preset.
  bool are_alike() const {
    return (torque.array() == torque.x()).all() && (momentum.array() == momentum.x()).all() &&
           preset.isZero(0);
  }
};

/// What the grip of a latched target can bear. Off by default.
struct GripSpec {
  std::optional<double> force;   ///< N; empty: any
  std::optional<double> moment;  ///< N m, about the hand's origin; empty: any
  bool is_limited() const { return force || moment; }
};

/// Attitude thrusters of the base, one pair per axis of B: moment -gain Htilde_omega omega, cut at
/// `torque` per axis. Off by default: the paper has none.
struct ThrusterSpec {
  double torque = 0;     ///< N m per axis; 0: there are none
  double gain = 1;       ///< 1/s
  double dead_band = 0;  ///< rad/s; they are off while |omega| is below
  bool exist() const { return torque > 0; }
};

/// Gains and horizon of the post-impact phase, and its criteria of success.
struct PostImpactSpec {
  std::vector<std::string> controllers;  ///< names as in the file; the first is the plan's choice
  double K_omega = 7;                    ///< 1/s
  double K_phi = 5;                      ///< 1/s
  double control_period = 0.01;          ///< s
  double horizon = 10;                   ///< s after the impact
  bool joint_friction = false;           ///< the plant has the robot file's joint friction
  double stop_restitution = 0;           ///< of the joint stops, [0, 1)
  WheelSpec wheels{.momentum = Vector3d::Constant(kAnyWheelMomentum)};
  GripSpec grip;
  double handback_start = 2;  ///< s after the impact; rns_handback
  double handback_gain = 1;   ///< 1/s; rns_handback
  ContactSpec contact;
  SensorSpec sensor;
  ControllerModelSpec model;
  ThrusterSpec thrusters;
  double residual_base_rate_max = 0;  ///< rad/s at the horizon under the chosen controller
  double attitude_change_max = 0;     ///< rad over the horizon under the chosen controller
};

}  // namespace stillbase
