// A step of several robots side by side, with the registers that this source file is compiled for.
#pragma once

#include "dynamics/momentum_kernel.hpp"
#include "simulation/controller_kernel.hpp"
#include "simulation/grip_kernel.hpp"
#include "simulation/lane_robot.hpp"
#include "simulation/motion_kernel.hpp"

namespace stillbase {

/// A state as in LaneStep, and its derivative.
template <class S>
struct LaneState {
  Vector3<S> position;
  Vector3<S> q;  ///< vector part of the quaternion
  S w;           ///< its scalar part
  JointVector<S> phi;
  Vector6<S> Omega;
  JointVector<S> phidot;

  explicit LaneState(int n) : phi(n), phidot(n) {}

  /// Calls action(number, index) for every number in the order of a column.
  template <class State, class Do>
  static void visit(State& state, Do action) {
    int i = 0;
    for (Eigen::Index k = 0; k < 3; ++k) action(state.position[k], i++);
    for (Eigen::Index k = 0; k < 3; ++k) action(state.q[k], i++);
    action(state.w, i++);
    for (Eigen::Index k = 0; k < state.phi.size(); ++k) action(state.phi[k], i++);
    for (Eigen::Index k = 0; k < 6; ++k) action(state.Omega[k], i++);
    for (Eigen::Index k = 0; k < state.phidot.size(); ++k) action(state.phidot[k], i++);
  }
  void load(const double* column) {
    visit(*this, [column](S& x, int i) { x = S::load(column + i * S::kLanes); });
  }
  void store(double* column) const {
    visit(*this, [column](const S& x, int i) { x.store(column + i * S::kLanes); });
  }
  /// this + h * rate
  LaneState moved(const LaneState& rate, double h) const {
    LaneState out = *this;
    out.add(rate, h);
    return out;
  }
  void add(const LaneState& rate, double h) {
    const S s(h);
    position += rate.position * s;
    q += rate.q * s;
    w += rate.w * s;
    Omega += rate.Omega * s;
    for (Eigen::Index k = 0; k < phi.size(); ++k) phi[k] += rate.phi[k] * s;
    for (Eigen::Index k = 0; k < phidot.size(); ++k) phidot[k] += rate.phidot[k] * s;
  }
  void normalise() {
    const S inverse = S(1) / sqrt(q.dot(q) + w * w);
    q *= inverse;
    w *= inverse;
  }
};

/// What acts on the robots during a step.
template <class S>
struct LaneLoad {
  Vector3<S> wheel_momentum;  ///< in B
  JointVector<S> tau;         ///< after limits
};

/// The acceleration by (3) with held torques and wheels.
/// @param factor of the inertia matrix
template <class S>
GeneralizedMotion<S> lane_acceleration(const InertiaFactor<S>& factor, const MotionTerms<S>& terms,
                                       const LaneState<S>& x, const LaneLoad<S>& load) {
  Vector6<S> F_b = Vector6<S>::Zero();
  const Vector3<S> omega = x.Omega.template tail<3>();
  F_b.template tail<3>() = -omega.cross(load.wheel_momentum);
  return acceleration_of<S>(factor, terms.bias, F_b, load.tau);
}

/// The derivative of a state: see ClosedLoop::derivative().
template <class S>
LaneState<S> lane_rate(const LaneState<S>& x, const GeneralizedMotion<S>& motion) {
  LaneState<S> out(static_cast<int>(x.phi.size()));
  const Vector3<S> v = x.Omega.template head<3>(), omega = x.Omega.template tail<3>();
  // The quaternion within a step is not quite of unit length: v is rotated by its direction.
  const Vector3<S> across = x.q.cross(v);
  const Vector3<S> turned = x.q.cross(across) + across * x.w;
  out.position = v + turned * (S(2) / (x.q.dot(x.q) + x.w * x.w));
  out.q = (omega * x.w + x.q.cross(omega)) * S(0.5);
  out.w = -x.q.dot(omega) * S(0.5);
  out.phi = x.phidot;
  out.Omega = motion.Omega;
  out.phidot = motion.phidot;
  return out;
}

template <class S>
LaneState<S> lane_rate_at(const LaneStep& step, const LaneRobot<S>& plant, const LaneState<S>& x,
                          const LaneLoad<S>& load) {
  const MotionTerms<S> terms(plant, *step.rotor_inertia, x.phi, x.Omega, x.phidot);
  const auto factor = factorize_inertia<S>(terms.inertia, *step.nothing_added, *step.none_locked);
  return lane_rate<S>(x, lane_acceleration<S>(factor, terms, x, load));
}

/// Torques of a control instant, before limits and after them.
/// @param terms, tilde, known, measured what the controller knows
/// @param phidot true joint rates, which the drives' limits depend on
template <class S>
void command_lanes(const LaneStep& step, const MotionTerms<S>& terms, const TildeInertia<S>& tilde,
                   const RobotModel& known, const LaneState<S>& measured,
                   const JointVector<S>& phidot, LaneLoad<S>& load) {
  const Vector3<S> omega = measured.Omega.template tail<3>();
  const Vector3<S> t_b = -omega.cross(load.wheel_momentum);
  JointVector<S> tau = joint_torque<S>(*step.controller, terms, tilde, omega, measured.phidot, t_b);
  const bool compensates =
      step.controller->friction_compensation && step.controller->kind != ControllerKind::None;
  for (Eigen::Index k = 0; k < tau.size(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (compensates) {
      tau[k] += compensated_friction<S>(*step.controller, known.joints[i], measured.phidot[k]);
    }
    tau[k].store(step.demanded + k * S::kLanes);
    load.tau[k] = limited_torque<S>(step.plant.pattern->joints[i], step.torque_limits,
                                    step.rate_limits, phidot[k], tau[k]);
    load.tau[k].store(step.tau + k * S::kLanes);
  }
}

template <class S>
void observe_lanes(const LaneStep& step, const LaneRobot<S>& plant, const MotionTerms<S>& terms,
                   const TildeInertia<S>& tilde, const LaneState<S>& x,
                   const GeneralizedMotion<S>& motion) {
  using At = ObservationOffset;
  const auto put = [&step](int i, const S& value) { value.store(step.observed + i * S::kLanes); };
  const auto put3 = [&put](int i, const Vector3<S>& value) {
    for (int k = 0; k < 3; ++k) put(i + k, value[k]);
  };
  const Momentum<S> momentum = compute_momentum<S>(terms.inertia, tilde, x.Omega, x.phidot);
  put3(At::base, momentum.base);
  put3(At::coupling, momentum.coupling);
  put3(At::P, momentum.P);
  put(At::energy, kinetic_energy_of<S>(terms.inertia, x.Omega, x.phidot));
  put(At::inertia, tilde.Htilde_omega(0, 0) + tilde.Htilde_omega(1, 1) + tilde.Htilde_omega(2, 2));
  if (step.sensors != nullptr) {
    put(At::seen, momentum_in_deviations<S>(*step.sensors, tilde, momentum.L_g));
  }
  if (is_reaction_null_space_control(step.controller->kind)) {
    const auto transfer =
        compute_momentum_transfer<S>(*step.controller, tilde.Htilde_omegaphi, momentum.L_g);
    put(At::rank, transfer.rank);
    put3(At::unreachable, transfer.unreachable(momentum.L_g));
  }
  if (step.held == nullptr) return;
  const auto held = [&step](int i) { return S::load(step.held + i * S::kLanes); };
  Matrix3<S> inertia, axes;
  Vector3<S> position;
  for (int i = 0; i < 9; ++i) inertia(i % 3, i / 3) = held(1 + i);
  for (int i = 0; i < 3; ++i) position[i] = held(10 + i);
  for (int i = 0; i < 9; ++i) axes(i % 3, i / 3) = held(13 + i);
  const Vector6<S> wrench =
      kernel::grip_wrench<S>(held(0), inertia, position, axes, plant, terms.kinematics, x.Omega,
                             x.phidot, motion.Omega, motion.phidot);
  for (int i = 0; i < 6; ++i) put(At::grip + i, wrench[i]);
}

template <class S>
void advance_lanes(const LaneStep& step) {
  const LaneRobot<S> plant(step.plant);
  const int n = plant.n();
  LaneState<S> x(n);
  x.load(step.state);
  const MotionTerms<S> terms(plant, *step.rotor_inertia, x.phi, x.Omega, x.phidot);
  const TildeInertia<S> tilde = compute_tilde_inertia<S>(terms.inertia);
  LaneLoad<S> load;
  load.tau.resize(n);
  for (int i = 0; i < 3; ++i) load.wheel_momentum[i] = S::load(step.wheel_momentum + i * S::kLanes);
  if (!step.commands) {
    for (int k = 0; k < n; ++k) load.tau[k] = S::load(step.tau + k * S::kLanes);
  } else if (step.known.pattern == nullptr) {
    command_lanes<S>(step, terms, tilde, *step.plant.pattern, x, x.phidot, load);
  } else {
    const LaneRobot<S> known(step.known);
    LaneState<S> measured(n);
    measured.load(step.measured);
    const MotionTerms<S> own(known, *step.rotor_inertia, measured.phi, measured.Omega,
                             measured.phidot);
    command_lanes<S>(step, own, compute_tilde_inertia<S>(own.inertia), known.pattern, measured,
                     x.phidot, load);
  }
  const auto factor =
      factorize_inertia<S>(terms.inertia, tilde, *step.nothing_added, *step.none_locked);
  const GeneralizedMotion<S> motion = lane_acceleration<S>(factor, terms, x, load);
  observe_lanes<S>(step, plant, terms, tilde, x, motion);
  const double h = step.h;
  if (h == 0) return;

  const LaneState<S> k1 = lane_rate<S>(x, motion);
  const LaneState<S> k2 = lane_rate_at<S>(step, plant, x.moved(k1, 0.5 * h), load);
  if (step.is_midpoint) {
    x.add(k2, h);
  } else {
    const LaneState<S> k3 = lane_rate_at<S>(step, plant, x.moved(k2, 0.5 * h), load);
    const LaneState<S> k4 = lane_rate_at<S>(step, plant, x.moved(k3, h), load);
    x.add(k1, h / 6);
    x.add(k2, h / 3);
    x.add(k3, h / 3);
    x.add(k4, h / 6);
  }
  x.normalise();
  x.store(step.state);
}

/// @tparam P pack type, which carries the instruction set in its name
template <class P>
constexpr LaneKernel lane_kernel(bool (*runs_here)()) {
  return {P::kLanes, kMaxJointsOf<P>, runs_here,
          [](const LaneStep& step) { advance_lanes<P>(step); }};
}

}  // namespace stillbase
