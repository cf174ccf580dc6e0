#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <stillbase/core/error.hpp>
#include <stillbase/simulation/contact.hpp>

#include "simulation/closed_loop.hpp"

namespace stillbase {
namespace {

struct PairMomentum {
  Vector3d linear, angular;  // in N, about its origin
};

PairMomentum pair_momentum(const RobotModel& robot, const JointVectord& rotors,
                           const EncounterPlant& encounter, const PlantState& state,
                           const TargetPlantState& target) {
  const PlantTerms terms(robot, rotors, state);
  const Momentum<double> m =
      compute_momentum(terms.inertia, terms.tilde, state.Omega, state.phidot);
  const Eigen::Quaterniond& R_NB = state.base.orientation;
  PairMomentum sum{R_NB * m.P, R_NB * Vector3d(m.L_g + state.wheel_momentum)};
  sum.angular += (state.base * terms.inertia.r_bg).cross(sum.linear);
  const Vector3d p = encounter.mass * target.velocity;
  sum.linear += p;
  sum.angular += target.pose.position.cross(p) +
                 target.pose.orientation * Vector3d(encounter.inertia * target.angular_velocity);
  return sum;
}

void check(const RobotModel& robot, const TargetPlantState& target,
           const EncounterPlant& encounter) {
  std::vector<Finding> findings;
  const auto require = [&](bool holds, const char* rule, const char* message) {
    if (!holds) findings.push_back({"simulation", 0, rule, message});
  };
  const CompliantContact& contact = encounter.contact;
  require(encounter.mass > 0 && std::isfinite(encounter.mass) && encounter.inertia.allFinite(),
          "target-mass", "must be finite and above zero");
  require(contact.stiffness > 0 && std::isfinite(contact.stiffness) && contact.damping >= 0 &&
              std::isfinite(contact.damping) && contact.friction >= 0 && contact.slip_rate > 0,
          "contact", "stiffness and slip rate must be above zero, damping and friction not below");
  require(std::abs(contact.normal.norm() - 1) < 1e-6 && contact.point.allFinite(), "contact-normal",
          "must be a unit vector");
  require(target.pose.position.allFinite() && target.velocity.allFinite() &&
              target.angular_velocity.allFinite() &&
              std::abs(target.pose.orientation.norm() - 1) < 1e-6,
          "target-state", "must be finite, the orientation a unit quaternion");
  const Eigen::Index servo = encounter.servo.stiffness.size();
  require(servo == 0 || (servo == robot.n() && encounter.servo.damping.size() == servo &&
                         encounter.servo_posture.size() == servo),
          "servo", "stiffness, damping and posture need one number per joint");
  if (!findings.empty()) throw InputError(std::move(findings));
}

/// The rate -x' with which the unit oscillator leaves the contact.
double leaving_rate(double zeta) {
  // Force over stiffness is x + 2 zeta x' = -x''. Closed forms of x by the sign of 1 - zeta^2.
  if (zeta < 1) {
    const double w = std::sqrt(1 - zeta * zeta);
    const double t = std::atan2(2 * zeta * w, 2 * zeta * zeta - 1) / w;
    return std::exp(-zeta * t);
  }
  if (zeta == 1) return std::exp(-2.0);
  const double w = std::sqrt(zeta * zeta - 1);
  const double t = std::atanh(2 * zeta * w / (2 * zeta * zeta - 1)) / w;
  return std::exp(-zeta * t);
}

}  // namespace

double contact_damping(double restitution, double stiffness, double effective_mass) {
  if (!(restitution >= kLeastRestitution && restitution <= 1)) {
    throw std::invalid_argument("a spring-damper needs a restitution in [0.001, 1]");
  }
  double low = 0, high = 100;  // leaving_rate falls from 1 to below kLeastRestitution
  for (int i = 0; i < 200; ++i) {
    const double zeta = 0.5 * (low + high);
    (leaving_rate(zeta) > restitution ? low : high) = zeta;
  }
  return 2 * low * std::sqrt(stiffness * effective_mass);
}

HandLoad contact_load(const CompliantContact& contact, const TargetPlantState& target,
                      const Vector3d& hand, const Vector3d& hand_velocity) {
  const Eigen::Quaterniond& R_NT = target.pose.orientation;
  const Vector3d n = R_NT * contact.normal;
  const Vector3d omega = R_NT * target.angular_velocity;
  const Vector3d offset = hand - target.pose * contact.point;
  // The gap rotates with the target, so its rate is that of the hand against the material point of
  // the target under it.
  const Vector3d relative =
      hand_velocity - target.velocity - omega.cross(hand - target.pose.position);
  HandLoad load;
  load.gap = n.dot(offset);
  load.gap_rate = n.dot(relative);
  load.normal_force = -contact.stiffness * load.gap - contact.damping * load.gap_rate;
  const double pressing = std::max(0.0, load.normal_force);
  const Vector3d slip = relative - load.gap_rate * n;
  load.force_N = pressing * n;
  if (contact.friction > 0) {
    load.force_N -= contact.friction * pressing / std::max(slip.norm(), contact.slip_rate) * slip;
  }
  return load;
}

EncounterResult simulate_encounter(const RobotModel& robot, const JointResistance& resistance,
                                   const PlantState& robot_start,
                                   const TargetPlantState& target_start,
                                   const EncounterPlant& encounter, const Controller& controller,
                                   const SimulationOptions& options) {
  check_simulation(robot, resistance, robot_start, controller, options);
  check(robot, target_start, encounter);
  const JointVectord rotors = added_plant_inertia(resistance, robot.n());
  ClosedLoop loop(robot, rotors, controller, options, &encounter);
  StateVector x = pack(robot_start, target_start);
  double t = 0;
  EncounterResult result;
  result.simulation = run_loop(loop, x, t, robot, controller, options);
  result.contact = loop.contact();
  result.target_end = unpack_target(x, robot.n());

  const PlantState end = unpack(x, robot.n());
  const PlantTerms terms(robot, rotors, end);
  const HandJacobian<double> jacobian = compute_hand_jacobian(robot, terms.kinematics);
  const Vector6d V_h = jacobian.R_bh * end.Omega + jacobian.J_phi * end.phidot;
  const HandLoad hand =
      contact_load(encounter.contact, result.target_end, end.base * terms.kinematics.r_bh,
                   end.base.orientation * V_h.head<3>());
  result.separation_speed = hand.gap_rate;
  result.impulse_N = encounter.mass * (target_start.velocity - result.target_end.velocity);

  const PairMomentum before = pair_momentum(robot, rotors, encounter, robot_start, target_start);
  const PairMomentum after = pair_momentum(robot, rotors, encounter, end, result.target_end);
  const double p = std::max(before.linear.norm(), encounter.mass * target_start.velocity.norm());
  const double reach = 1 + target_start.pose.position.norm();
  result.momentum_error = std::max((after.linear - before.linear).norm(),
                                   (after.angular - before.angular).norm() / reach) /
                          std::max(p, 1e-12);
  return result;
}

}  // namespace stillbase
