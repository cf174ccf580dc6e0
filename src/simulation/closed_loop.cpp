#include "simulation/closed_loop.hpp"

#include <algorithm>

namespace stillbase {
namespace {

int joint_count(const StateVector& x) { return static_cast<int>(x.size() - 13) / 2; }

/// No robot turns or flies that fast; a larger number means that the integration has failed.
constexpr double kLargestState = 1e12;

}  // namespace

StateVector pack(const PlantState& state) {
  const Eigen::Index n = state.phi.size();
  StateVector x(13 + 2 * n);
  x.segment<3>(0) = state.base.position;
  x.segment<4>(3) = state.base.orientation.coeffs();
  x.segment(7, n) = state.phi;
  x.segment<6>(7 + n) = state.Omega;
  x.segment(13 + n, n) = state.phidot;
  return x;
}

PlantState unpack(const StateVector& x) {
  const Eigen::Index n = joint_count(x);
  PlantState state;
  state.base.position = x.segment<3>(0);
  state.base.orientation.coeffs() = x.segment<4>(3);
  state.base.orientation.normalize();
  state.phi = x.segment(7, n);
  state.Omega = x.segment<6>(7 + n);
  state.phidot = x.segment(13 + n, n);
  return state;
}

void normalise_attitude(StateVector& x) { x.segment<4>(3).normalize(); }

bool is_bounded(const StateVector& x) {
  return x.allFinite() && x.lpNorm<Eigen::Infinity>() < kLargestState;
}

ClosedLoop::ClosedLoop(const RobotModel& robot, const JointVectord& rotor_inertia,
                       const Controller& controller, const SimulationOptions& options)
    : robot_(robot),
      rotor_inertia_(rotor_inertia),
      controller_(controller),
      options_(options),
      held_(JointVectord::Zero(robot.n())) {}

JointVectord ClosedLoop::limited(const JointVectord& tau, bool& saturated) const {
  saturated = false;
  JointVectord applied = tau;
  if (!options_.torque_limits) return applied;
  for (int k = 0; k < robot_.n(); ++k) {
    const double limit = robot_.joints[static_cast<std::size_t>(k)].max_effort;
    applied[k] = std::clamp(tau[k], -limit, limit);
    if (applied[k] != tau[k]) saturated = true;
  }
  return applied;
}

void ClosedLoop::derivative(double t, const StateVector& x, StateVector& dxdt,
                            StepObserver* observer) {
  const Eigen::Index n = robot_.n();
  const PlantState state = unpack(x);
  const PlantTerms terms(robot_, rotor_inertia_, state);

  const bool continuous = options_.control_period <= 0;
  if (continuous || sample_now_) {
    held_ = limited(control_torque(controller_, robot_, terms, state), held_saturated_);
    sample_now_ = false;
  }
  if (observer != nullptr) observer->observe(t, state, terms, held_, held_saturated_);

  JointVectord tau = held_;
  if (options_.friction) {
    tau += joint_friction(robot_, state.phidot, options_.friction_transition_rate);
  }
  const Vector6d F_b =
      options_.base_wrench ? options_.base_wrench(t, state) : Vector6d(Vector6d::Zero());
  const PlantAcceleration acceleration = compute_acceleration(terms, F_b, tau);

  dxdt.resize(x.size());
  dxdt.segment<3>(0) = state.base.orientation * state.Omega.head<3>();
  // On the quaternion as integrated, whatever its length: see the header of simulate.hpp.
  const Eigen::Quaterniond q(x[6], x[3], x[4], x[5]);
  const Vector3d omega = state.Omega.tail<3>();
  dxdt.segment<4>(3) = 0.5 * (q * Eigen::Quaterniond(0, omega.x(), omega.y(), omega.z())).coeffs();
  dxdt.segment(7, n) = state.phidot;
  dxdt.segment<6>(7 + n) = acceleration.dot_Omega;
  dxdt.segment(13 + n, n) = acceleration.phiddot;
}

}  // namespace stillbase
