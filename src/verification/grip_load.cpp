#include "verification/grip_load.hpp"

#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/rotation.hpp>

namespace stillbase::verification {
namespace {

/// The rate of momentum by differences, and its tolerance.
struct GripLoadOptions {
  double instant = 1e-4;      ///< s: differences are wrong by its square
  double same_wrench = 1e-6;  ///< relative to the largest one
};
constexpr GripLoadOptions kGripLoad;

/// Momentum of the held target in N, the angular one about a point fixed there.
Vector6d target_momentum(const Context& context, const PlantState& state, const Vector3d& about) {
  const reference::MetBody body = met_body(context.problem, context.situation.event);
  const auto& contact = context.situation.response.dynamics;
  const auto now =
      reference::compute(context.problem.robot, {state.phi, state.phidot, state.Omega});
  // From the axes at the contact to those of now, both of the hand in B.
  const Matrix3d carried = now.hand_rotation * contact.hand_rotation.transpose();
  Eigen::VectorXd x(6 + state.phi.size());
  x << state.Omega, state.phidot;
  const Vector6d hand = now.J * x;
  const Vector3d omega = hand.tail<3>(), arm = -(carried * body.r);
  const Vector3d p = body.mass * (hand.head<3>() + omega.cross(arm));
  const Matrix3d inertia = carried * body.inertia * carried.transpose();
  const Eigen::Quaterniond& R_NB = state.base.orientation;
  const Vector3d place = state.base * Vector3d(now.hand_position + arm);
  Vector6d momentum;
  momentum.head<3>() = R_NB * p;
  momentum.tail<3>() =
      R_NB * Vector3d(inertia * omega) + (place - about).cross(Vector3d(momentum.head<3>()));
  return momentum;
}

/// Accelerations [dot Omega; phi''] of the run at a sample.
Eigen::VectorXd acceleration_at(const Context& context, const RobotModel& robot,
                                const TraceSample& sample) {
  const PlantState& state = sample.state;
  auto d = reference::compute(robot, {state.phi, state.phidot, state.Omega});
  const JointResistance& resistance = context.problem.resistance;
  if (resistance.model == ResistanceModel::RotorInertia) {
    d.H.diagonal().tail(robot.n()) += resistance.rotor_inertia;
  }
  Eigen::VectorXd load = -d.c;
  const Vector3d omega = state.Omega.tail<3>();
  load.segment<3>(3) +=
      sample.wheel_torque + sample.thruster_torque - omega.cross(state.wheel_momentum);
  load.tail(robot.n()) += sample.tau;
  return reference::solve_definite(d.H, load);
}

/// The state a little later (earlier), wrong by the square of that time.
PlantState moved(const PlantState& state, const Eigen::VectorXd& acceleration, double time) {
  PlantState out = state;
  const Eigen::Quaterniond& R_NB = state.base.orientation;
  out.base.position += time * (R_NB * Vector3d(state.Omega.head<3>()));
  const Vector3d rotation = time * state.Omega.tail<3>();
  out.base.orientation = (R_NB * Eigen::Quaterniond(rotation_exp(rotation))).normalized();
  out.phi += time * state.phidot;
  out.Omega += time * acceleration.head<6>();
  out.phidot += time * acceleration.tail(state.phi.size());
  return out;
}

}  // namespace

void check_grip_load(const Context& context, const AfterContact& run, ClaimList& claims) {
  if (!run.is_held) return;
  const char* const name = "grip_wrench";
  if (context.problem.post_impact.joint_friction) {
    return claims.not_verified(name, "joints have friction");
  }
  if (run.simulation.summary.stop_hits > 0) {
    return claims.not_verified(name, "a joint rests at its stop");
  }
  const std::vector<TraceSample>& trace = run.simulation.trace;
  Vector6d largest = Vector6d::Zero(), error = Vector6d::Zero();
  for (const TraceSample& sample : trace) {
    const PlantState& state = sample.state;
    const auto d =
        reference::compute(context.problem.robot, {state.phi, state.phidot, state.Omega});
    const Vector3d hand = state.base * Vector3d(d.hand_position);
    const Eigen::VectorXd a = acceleration_at(context, run.robot, sample);
    const Vector6d rate = (target_momentum(context, moved(state, a, kGripLoad.instant), hand) -
                           target_momentum(context, moved(state, a, -kGripLoad.instant), hand)) /
                          (2 * kGripLoad.instant);
    Vector6d own;
    own << state.base.orientation.conjugate() * Vector3d(rate.head<3>()),
        state.base.orientation.conjugate() * Vector3d(rate.tail<3>());
    largest = largest.cwiseMax(own.cwiseAbs());
    error = error.cwiseMax((own - sample.grip_wrench).cwiseAbs());
  }
  const double force = error.head<3>().norm(), moment = error.tail<3>().norm();
  const double apart = std::max(force > 0 ? force / largest.head<3>().norm() : 0,
                                moment > 0 ? moment / largest.tail<3>().norm() : 0);
  claims.same(name, apart, kGripLoad.same_wrench,
              fmt::format("wrench on the held target against the rate of its momentum, at {} "
                          "instants; up to {:.3g} N, {:.3g} N m",
                          trace.size(), largest.head<3>().norm(), largest.tail<3>().norm()));
}

}  // namespace stillbase::verification
