#include "simulation/closed_loop.hpp"

#include <algorithm>
#include <cmath>

#include "core/normal_pairs.hpp"
#include "simulation/controller_kernel.hpp"

namespace stillbase {
namespace {

/// Larger numbers mean that the integration has failed.
constexpr double kLargestState = 1e12;

/// dq/dt = 1/2 q (0, omega) on the quaternion as integrated, of any length: see simulate.hpp.
Eigen::Vector4d quaternion_rate(const StateVector& x, Eigen::Index at, const Vector3d& omega) {
  const Eigen::Quaterniond q(x[at + 3], x[at], x[at + 1], x[at + 2]);
  return 0.5 * (q * Eigen::Quaterniond(0, omega.x(), omega.y(), omega.z())).coeffs();
}

Eigen::Index target_at(int n) { return 19 + 2 * n; }

}  // namespace

StateVector pack(const PlantState& state) {
  const Eigen::Index n = state.phi.size();
  StateVector x(19 + 2 * n);
  x.segment<3>(0) = state.base.position;
  x.segment<4>(3) = state.base.orientation.coeffs();
  x.segment(7, n) = state.phi;
  x.segment<6>(7 + n) = state.Omega;
  x.segment(13 + n, n) = state.phidot;
  x.segment<3>(13 + 2 * n) = state.wheel_momentum;
  x.segment<3>(16 + 2 * n) = state.thruster_impulse;
  return x;
}

StateVector pack(const PlantState& state, const TargetPlantState& target) {
  const Eigen::Index at = target_at(static_cast<int>(state.phi.size()));
  StateVector x(at + kTargetSize);
  x.head(at) = pack(state);
  x.segment<3>(at) = target.pose.position;
  x.segment<4>(at + 3) = target.pose.orientation.coeffs();
  x.segment<3>(at + 7) = target.velocity;
  x.segment<3>(at + 10) = target.angular_velocity;
  return x;
}

PlantState unpack(const StateVector& x, int n) {
  PlantState state;
  state.base.position = x.segment<3>(0);
  state.base.orientation.coeffs() = x.segment<4>(3);
  state.base.orientation.normalize();
  state.phi = x.segment(7, n);
  state.Omega = x.segment<6>(7 + n);
  state.phidot = x.segment(13 + n, n);
  state.wheel_momentum = x.segment<3>(13 + 2 * n);
  state.thruster_impulse = x.segment<3>(16 + 2 * n);
  return state;
}

TargetPlantState unpack_target(const StateVector& x, int n) {
  const Eigen::Index at = target_at(n);
  TargetPlantState target;
  target.pose.position = x.segment<3>(at);
  target.pose.orientation.coeffs() = x.segment<4>(at + 3);
  target.pose.orientation.normalize();
  target.velocity = x.segment<3>(at + 7);
  target.angular_velocity = x.segment<3>(at + 10);
  return target;
}

void normalise_attitude(StateVector& x, int n) {
  x.segment<4>(3).normalize();
  if (x.size() > target_at(n)) x.segment<4>(target_at(n) + 3).normalize();
}

bool is_bounded(const StateVector& x) {
  return x.allFinite() && x.lpNorm<Eigen::Infinity>() < kLargestState;
}

Sensing::Sensing(const SensorSpec& sensors, double control_period)
    : sensors_(sensors),
      is_exact_(sensors.are_exact()),
      delay_(is_exact_ ? 0 : static_cast<std::size_t>(std::lround(sensors.delay / control_period))),
      random_(sensors.seed, sensors.stream) {}

PlantState Sensing::measure(const PlantState& state) {
  PlantState measured = state;
  add_normals(random_, sensors_.base_rate_error, measured.Omega.tail<3>());
  add_normals(random_, sensors_.joint_position_error, measured.phi);
  add_normals(random_, sensors_.joint_rate_error, measured.phidot);
  if (delay_ == 0) return measured;
  delayed_.push_back(std::move(measured));
  if (delayed_.size() > delay_ + 1) delayed_.pop_front();
  return delayed_.front();
}

ClosedLoop::ClosedLoop(const RobotModel& robot, const JointVectord& rotor_inertia,
                       const Controller& controller, const SimulationOptions& options,
                       const EncounterPlant* encounter)
    : robot_(robot),
      rotor_inertia_(rotor_inertia),
      controller_(controller),
      options_(options),
      encounter_(encounter),
      sensing_(options.sensors, options.control_period),
      command_{JointVectord::Zero(robot.n())},
      demanded_(JointVectord::Zero(robot.n())) {}

void ClosedLoop::go_on_from(const Sensing& sensing, const ControlCommand& command,
                            const JointVectord& demanded, bool saturated) {
  sensing_ = sensing;
  command_ = command;
  demanded_ = demanded;
  saturated_ = saturated;
}

bool ClosedLoop::knows_terms_at(const StateVector& x) const {
  return terms_ && terms_x_.size() == x.size() && terms_x_ == x;
}

const PlantTerms& ClosedLoop::terms_at(const StateVector& x, const PlantState& state) {
  if (!knows_terms_at(x)) {
    terms_.emplace(robot_, rotor_inertia_, state);
    terms_x_ = x;
  }
  return *terms_;
}

PlantAcceleration ClosedLoop::acceleration(const StateVector& x, const PlantState& state,
                                           const Load& load) {
  if (knows_terms_at(x)) return compute_acceleration(*terms_, load.F_b, load.tau, held_);
  return compute_acceleration(robot_, rotor_inertia_, state, load.F_b, load.tau, held_);
}

void ClosedLoop::sample(double t, const StateVector& x) {
  if (options_.control_period <= 0) return;
  const PlantState state = unpack(x, n());
  const double elapsed = t - options_.start_time;
  if (sensing_.is_exact()) {
    command(state, terms_at(x, state), elapsed);
  } else {
    const PlantState measured = sensing_.measure(state);
    command(measured, PlantTerms(robot_, rotor_inertia_, measured), elapsed);
  }
  limit(state.phidot);
}

void ClosedLoop::command(const PlantState& state, const PlantTerms& terms, double elapsed) {
  const auto decide = [&](const RobotModel& model, const PlantTerms& own) {
    command_ = control_command(controller_, options_.wheels, model, own, state, elapsed,
                               options_.grasp, options_.control_period);
    command_.thruster_torque = thruster_torque(options_.thrusters, own, state);
  };
  if (!options_.controller_robot) return decide(robot_, terms);
  decide(*options_.controller_robot, PlantTerms(*options_.controller_robot, rotor_inertia_, state));
}

void ClosedLoop::limit(const JointVectord& phidot) {
  saturated_ = false;
  demanded_ = command_.tau;
  for (int k = 0; k < n(); ++k) {
    const Joint& joint = robot_.joints[k];
    double& tau = command_.tau[k];
    tau =
        limited_torque<double>(joint, options_.torque_limits, options_.rate_limits, phidot[k], tau);
    saturated_ = saturated_ || is_cut(joint, demanded_[k], tau);
  }
  const Vector3d& most = options_.wheels.torque;
  command_.wheel_torque = command_.wheel_torque.cwiseMax(-most).cwiseMin(most);
}

double ClosedLoop::coulomb(int k) const {
  return options_.friction ? robot_.joints[k].coulomb_friction : 0;
}

ClosedLoop::Load ClosedLoop::load(double t, const StateVector& x, const PlantState& state) {
  Load load{Vector6d::Zero(), command_.tau};
  if (options_.friction) {
    for (int k = 0; k < n(); ++k) {
      const Joint& joint = robot_.joints[k];
      load.tau[k] -= joint.viscous_friction * state.phidot[k];
      load.tau[k] -= joint.coulomb_friction * slides_[k];
    }
  }
  if (options_.wheels.exist()) {
    const Vector3d omega = state.Omega.tail<3>();
    load.F_b.tail<3>() += command_.wheel_torque - omega.cross(state.wheel_momentum);
  }
  load.F_b.tail<3>() += command_.thruster_torque;
  if (options_.base_wrench) load.F_b += options_.base_wrench(t, state);
  if (encounter_ == nullptr) return load;
  if (contact_.phase == ContactPhase::Touching) {
    const PlantTerms& terms = terms_at(x, state);
    const HandLoad hand = hand_load(x, state, terms);
    Vector6d F_h;
    F_h << state.base.orientation.conjugate() * hand.force_N, Vector3d::Zero();
    const HandJacobian<double> jacobian = compute_hand_jacobian(robot_, terms.kinematics);
    load.F_b += jacobian.R_bh.transpose() * F_h;
    load.tau += jacobian.J_phi.transpose() * F_h;
  }
  const ContactServo& servo = encounter_->servo;
  if (servo.stiffness.size() == n() && !contact_.has_separated) {
    load.tau -= servo.stiffness.cwiseProduct(state.phi - encounter_->servo_posture);
    load.tau -= servo.damping.cwiseProduct(state.phidot);
  }
  return load;
}

void ClosedLoop::derivative(double t, const StateVector& x, StateVector& dxdt, Recorder* recorder) {
  const PlantState state = unpack(x, n());
  if (options_.control_period <= 0) {
    command(state, terms_at(x, state), t - options_.start_time);
    limit(state.phidot);
  }
  if (recorder != nullptr)
    terms_at(x, state);  // it looks at them: the acceleration takes them, too
  const PlantAcceleration acceleration = this->acceleration(x, state, load(t, x, state));
  if (recorder != nullptr) {
    const PlantTerms& terms = terms_at(x, state);
    if (options_.grasp.target) {
      recorder->observe_grip(
          grip_wrench(*options_.grasp.target, robot_, terms.kinematics, state, acceleration));
    }
    if (encounter_ != nullptr) {
      const bool touches = contact_.phase == ContactPhase::Touching;
      recorder->observe_target(unpack_target(x, n()), touches ? hand_load(x, state, terms).force_N
                                                              : Vector3d(Vector3d::Zero()));
    }
    Observation now{t, state, command_, demanded_, saturated_};
    observe_terms(controller_, options_.sensors, terms, now);
    recorder->observe(now);
  }

  const Eigen::Index N = n();
  dxdt.resize(x.size());
  dxdt.segment<3>(0) = state.base.orientation * state.Omega.head<3>();
  dxdt.segment<4>(3) = quaternion_rate(x, 3, state.Omega.tail<3>());
  dxdt.segment(7, N) = state.phidot;
  dxdt.segment<6>(7 + N) = acceleration.dot_Omega;
  dxdt.segment(13 + N, N) = acceleration.phiddot;
  dxdt.segment<3>(13 + 2 * N) = -command_.wheel_torque;
  dxdt.segment<3>(16 + 2 * N).setZero();
  if (options_.thrusters.exist()) {
    dxdt.segment<3>(16 + 2 * N) = state.base.orientation * command_.thruster_torque;
  }
  if (encounter_ == nullptr) return;

  const Eigen::Index at = target_at(n());
  const TargetPlantState target = unpack_target(x, n());
  Vector3d force = Vector3d::Zero();
  Vector3d moment = Vector3d::Zero();  // in T
  if (contact_.phase == ContactPhase::Touching) {
    const PlantTerms& terms = terms_at(x, state);
    force = -hand_load(x, state, terms).force_N;
    const Vector3d hand = state.base * terms.kinematics.r_bh;
    const Vector3d arm_N = hand - target.pose.position;
    moment = target.pose.orientation.conjugate() * arm_N.cross(force);
  }
  dxdt.segment<3>(at) = target.velocity;
  dxdt.segment<4>(at + 3) = quaternion_rate(x, at + 3, target.angular_velocity);
  dxdt.segment<3>(at + 7) = force / encounter_->mass;
  dxdt.segment<3>(at + 10).setZero();
  if (encounter_->is_point_mass()) return;
  const Vector3d spin = encounter_->inertia * target.angular_velocity;
  dxdt.segment<3>(at + 10) =
      encounter_->inertia.ldlt().solve(moment - target.angular_velocity.cross(spin));
}

}  // namespace stillbase
