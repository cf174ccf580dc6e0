#include "simulation/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <stillbase/dynamics/reaction_null_space.hpp>

#include "simulation/controller_kernel.hpp"

namespace stillbase {
namespace {

/// Momentum below this fraction of the total is rounding, not lost.
constexpr double kNoMomentum = 1e-9;
/// Of the angular momentum that the first kinetic energy could hold: what a run that has none shows
/// by its integration.
constexpr double kNoRotation = 1e-6;

TraceSample make_sample(const RobotModel& robot, const Observation& now) {
  TraceSample sample;
  sample.time = now.time;
  sample.state = now.state;
  sample.base = now.momentum.base;
  sample.coupling = now.momentum.coupling;
  sample.total = now.momentum.L_g;
  sample.total_N = now.state.base.orientation * now.momentum.L_g;
  sample.P_N = now.state.base.orientation * now.momentum.P;
  const auto tilde =
      now.terms != nullptr
          ? now.terms->tilde
          : compute_tilde_inertia(compute_inertia(robot, compute_kinematics(robot, now.state.phi)));
  const JointVelocityParts parts =
      decompose_joint_velocity(angular_reaction_null_space(tilde), now.state.phidot);
  sample.rns = parts.rns;
  sample.orthogonal = parts.orthogonal;
  sample.tau = now.command.tau;
  sample.demanded_tau = now.demanded;
  sample.wheel_torque = now.command.wheel_torque;
  sample.thruster_torque = now.command.thruster_torque;
  sample.kinetic_energy = now.kinetic_energy;
  return sample;
}

/// First zero in [0, 1] of the cubic Hermite segment from (y0, slope m0) to (y1, slope m1) with
/// y0 <= 0 < y1, by bisection.
double hermite_crossing(double y0, double m0, double y1, double m1) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double s = 0.5 * (low + high);
    const double r = 1 - s;
    const double y =
        r * r * (1 + 2 * s) * y0 + s * r * r * m0 + s * s * (3 - 2 * s) * y1 - s * s * r * m1;
    (y > 0 ? high : low) = s;
  }
  return high;
}

}  // namespace

void observe_terms(const Controller& controller, const SensorSpec& sensors, const PlantTerms& terms,
                   Observation& out) {
  const PlantState& state = out.state;
  out.momentum = compute_momentum(terms.inertia, terms.tilde, state.Omega, state.phidot);
  out.kinetic_energy = kinetic_energy(terms.inertia, state);
  out.mass = terms.inertia.mass;
  out.central_inertia = terms.tilde.Htilde_omega.trace();
  if (!sensors.are_exact()) {
    out.momentum_seen = momentum_in_deviations<double>(sensors, terms.tilde, out.momentum.L_g);
  }
  out.terms = &terms;
  if (!is_reaction_null_space_control(controller.kind)) return;
  const auto transfer =
      compute_momentum_transfer<double>(controller, terms.tilde.Htilde_omegaphi, out.momentum.L_g);
  out.rank = static_cast<int>(transfer.rank);
  out.unreachable = transfer.unreachable(out.momentum.L_g);
}

Recorder::Recorder(const RobotModel& robot, const Controller& controller,
                   const SimulationOptions& options)
    : robot_(robot), controller_(controller), options_(options) {
  result_.summary.peak_joint_rates = JointVectord::Zero(robot.n());
  result_.summary.peak_torques = JointVectord::Zero(robot.n());
  result_.summary.peak_demanded_torques = JointVectord::Zero(robot.n());
  result_.summary.near_limit.joint_rates = JointVectord::Zero(robot.n());
  result_.summary.near_limit.joint_torques = JointVectord::Zero(robot.n());
}

void Recorder::observe(const Observation& now) {
  const PlantState& state = now.state;
  const ControlCommand& command = now.command;
  const JointVectord& tau = command.tau;
  SimulationSummary& summary = result_.summary;
  if (!started_) start(now);

  summary.residual_base_rate = state.Omega.tail<3>().norm();
  summary.peak_base_rate = std::max(summary.peak_base_rate, summary.residual_base_rate);
  summary.attitude_turned_end = first_attitude_.angularDistance(state.base.orientation);
  summary.attitude_turned = std::max(summary.attitude_turned, summary.attitude_turned_end);
  summary.residual_joint_rate = state.phidot.norm();
  summary.peak_joint_rate = std::max(summary.peak_joint_rate, summary.residual_joint_rate);
  summary.peak_joint_rates = summary.peak_joint_rates.cwiseMax(state.phidot.cwiseAbs());
  summary.peak_torques = summary.peak_torques.cwiseMax(tau.cwiseAbs());
  summary.peak_demanded_torques = summary.peak_demanded_torques.cwiseMax(now.demanded.cwiseAbs());
  summary.peak_wheel_torque =
      std::max(summary.peak_wheel_torque, command.wheel_torque.lpNorm<Eigen::Infinity>());
  summary.peak_wheel_torques = summary.peak_wheel_torques.cwiseMax(command.wheel_torque.cwiseAbs());
  summary.peak_wheel_momenta = summary.peak_wheel_momenta.cwiseMax(state.wheel_momentum.cwiseAbs());
  summary.wheel_momentum = state.wheel_momentum;
  if (!started_) summary.lowest_positions = summary.highest_positions = state.phi;
  summary.lowest_positions = summary.lowest_positions.cwiseMin(state.phi);
  summary.highest_positions = summary.highest_positions.cwiseMax(state.phi);
  watch_loads(now);
  watch_rest(now);
  watch_momentum(now);
  if (is_reaction_null_space_control(controller_.kind)) watch_lost_momentum(now);
  if (now.saturated) {
    for (int k = 0; k < robot_.n(); ++k) {
      const double limit = robot_.joints[k].max_effort;
      if (std::abs(tau[k]) >= limit) note(k, LimitKind::Torque, now.time);
    }
  }
  watch_limits(now.time, state);

  if (record_now_) {
    result_.trace.push_back(make_sample(robot_, now));
    result_.trace.back().target = target_;
    result_.trace.back().contact_force = contact_force_;
    result_.trace.back().grip_wrench = grip_wrench_;
    record_now_ = false;
  }
  started_ = true;
  t_ = now.time;
  state_ = state;
}

void Recorder::start(const Observation& now) {
  const PlantState& state = now.state;
  first_attitude_ = state.base.orientation;
  first_P_N_ = state.base.orientation * now.momentum.P;
  first_L_N_ = state.base.orientation * Vector3d(now.momentum.L_g + state.wheel_momentum) -
               state.thruster_impulse;
  P_scale_ = std::sqrt(2 * now.mass * now.kinetic_energy);
  L_scale_ = std::sqrt(2 * now.central_inertia * now.kinetic_energy);
}

void Recorder::watch_loads(const Observation& now) {
  if (started_ && !result_.summary.rest_time) {
    const double h = now.time - t_;
    LoadTimes& times = result_.summary.near_limit;
    times.joint_rates += h * near_.joint_rates;
    times.joint_torques += h * near_.joint_torques;
    times.wheel_torques += h * near_.wheel_torques;
    times.grip_force += h * near_.grip_force;
    times.grip_moment += h * near_.grip_moment;
  }
  const auto is_near = [](double load, double limit) {
    return limit > 0 && std::abs(load) >= kNearLimit * limit ? 1.0 : 0.0;
  };
  near_.joint_rates.resize(robot_.n());
  near_.joint_torques.resize(robot_.n());
  for (int k = 0; k < robot_.n(); ++k) {
    const Joint& joint = robot_.joints[k];
    near_.joint_rates[k] = is_near(now.state.phidot[k], joint.max_velocity);
    near_.joint_torques[k] = is_near(now.demanded[k], joint.max_effort);
  }
  for (int i = 0; i < 3; ++i) {
    near_.wheel_torques[i] = is_near(now.command.wheel_torque[i], options_.wheels.torque[i]);
  }
  const GripSpec& grip = options_.grasp.limits;
  near_.grip_force = is_near(grip_wrench_.head<3>().norm(), grip.force.value_or(0));
  near_.grip_moment = is_near(grip_wrench_.tail<3>().norm(), grip.moment.value_or(0));
}

void Recorder::watch_momentum(const Observation& now) {
  const PlantState& state = now.state;
  const Momentum<double>& momentum = now.momentum;
  SimulationSummary& summary = result_.summary;
  const double P_drift = (state.base.orientation * momentum.P - first_P_N_).norm();
  const Vector3d L_N = state.base.orientation * Vector3d(momentum.L_g + state.wheel_momentum) -
                       state.thruster_impulse;
  const double L_drift = (L_N - first_L_N_).norm();
  summary.linear_momentum_drift = std::max(summary.linear_momentum_drift, P_drift);
  summary.angular_momentum_drift = std::max(summary.angular_momentum_drift, L_drift);
  if (P_scale_ > 0) {
    summary.relative_momentum_drift =
        std::max({summary.relative_momentum_drift, P_drift / P_scale_, L_drift / L_scale_});
  }
}

void Recorder::watch_lost_momentum(const Observation& now) {
  SimulationSummary& summary = result_.summary;
  summary.lowest_rank = std::min(summary.lowest_rank, now.rank);
  summary.lost_momentum = now.unreachable;
  const double lost = summary.lost_momentum.norm();
  summary.peak_lost_momentum = std::max(summary.peak_lost_momentum, lost);
  summary.lost_direction = Vector3d::Zero();
  const double scale = now.momentum.base.norm() + now.momentum.coupling.norm();
  if (lost > kNoMomentum * scale) summary.lost_direction = summary.lost_momentum / lost;
}

void Recorder::watch_rest(const Observation& now) {
  const PlantState& state = now.state;
  const double L_g = now.momentum.L_g.norm();
  // What comes to rest is what the contact leaves: sizes are those after it.
  const bool touches = !contact_force_.isZero(0);
  if (!started_ || (touched_ && !touches)) {
    rest_L_g_ = L_g;
    rest_L_scale_ = std::sqrt(2 * now.central_inertia * now.kinetic_energy);
  }
  touched_ = touches;
  const double rate = state.phidot.size() > 0 ? state.phidot.lpNorm<Eigen::Infinity>() : 0;
  peak_rate_ = std::max(peak_rate_, rate);
  const double least = std::max(kAtRest * rest_L_g_, kNoRotation * rest_L_scale_);
  const bool rests =
      !touches &&
      rate <= std::max({kJointsAtRest, kAtRest * peak_rate_, options_.sensors.joint_rate_error}) &&
      (L_g <= least || now.momentum_seen <= 1);
  std::optional<double>& since = result_.summary.rest_time;
  if (!rests) since.reset();
  if (rests && !since) since = std::max(now.time, 0.0);  // a compliant contact starts before zero
}

void Recorder::observe_grip(const Vector6d& wrench) {
  grip_wrench_ = wrench;
  SimulationSummary& summary = result_.summary;
  summary.peak_grip_force = std::max(summary.peak_grip_force, wrench.head<3>().norm());
  summary.peak_grip_moment = std::max(summary.peak_grip_moment, wrench.tail<3>().norm());
}

void Recorder::watch_limits(double t, const PlantState& state) {
  for (int k = 0; k < robot_.n(); ++k) {
    const Joint& joint = robot_.joints[k];
    if (std::abs(state.phidot[k]) > joint.max_velocity) note(k, LimitKind::Rate, t);
    if (!options_.joint_stops) watch_stops(k, t, state);
  }
}

void Recorder::observe_target(const TargetPlantState& target, const Vector3d& contact_force) {
  target_ = target;
  contact_force_ = contact_force;
  double& peak = result_.summary.peak_contact_force;
  peak = std::max(peak, contact_force.norm());
}

void Recorder::stop_reached(double t, int joint, LimitKind kind, double rate) {
  ++result_.summary.stop_hits;
  result_.summary.hardest_stop = std::max(result_.summary.hardest_stop, std::abs(rate));
  note(joint, kind, t);
}

void Recorder::watch_stops(int k, double t, const PlantState& state) {
  const Joint& joint = robot_.joints[k];
  const auto passed = [&](double sign, double stop, LimitKind kind) {
    const double y1 = sign * (state.phi[k] - stop);
    if (!(y1 > 0)) return;
    if (!started_) return note(k, kind, t);
    const double y0 = sign * (state_.phi[k] - stop);
    if (y0 > 0) return;
    const double h = t - t_;
    const double s =
        hermite_crossing(y0, sign * h * state_.phidot[k], y1, sign * h * state.phidot[k]);
    note(k, kind, t_ + s * h);
  };
  if (joint.lower > -kInfinity) passed(-1, joint.lower, LimitKind::LowerStop);
  if (joint.upper < kInfinity) passed(1, joint.upper, LimitKind::UpperStop);
}

void Recorder::note(int joint, LimitKind kind, double time) {
  for (const LimitEvent& event : result_.summary.limits) {
    if (event.joint == joint && event.kind == kind) return;
  }
  result_.summary.limits.push_back({joint, kind, time});
}

SimulationResult Recorder::take(SimulationStatus status, long steps) {
  SimulationSummary& summary = result_.summary;
  if (robot_.n() > 0) {
    summary.peak_torque = summary.peak_torques.maxCoeff();
    summary.peak_demanded_torque = summary.peak_demanded_torques.maxCoeff();
  }
  summary.steps = steps;
  std::stable_sort(summary.limits.begin(), summary.limits.end(),
                   [](const LimitEvent& a, const LimitEvent& b) { return a.time < b.time; });
  result_.status = status;
  return std::move(result_);
}

}  // namespace stillbase
