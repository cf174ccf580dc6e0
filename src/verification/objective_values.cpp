// Objectives and their measures over samples, by `reference`.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <stillbase/core/constants.hpp>
#include <stillbase/simulation/settings.hpp>

#include "verification/recomputation.hpp"

namespace stillbase::verification {
namespace {

/// The planner's fixed steps and the adaptive ones here, relative.
constexpr double kIntegratorsAgree = 1e-5;

}  // namespace

Vector6d scenario_impulse(const CaptureProblem& problem, const TargetMotion* motion,
                          const Configuration& configuration, const PostureResponse& response,
                          const Scenario& scenario) {
  const ImpulseSpec& impulse = problem.impulse;
  const Matrix3d R_BN = configuration.base.orientation.conjugate().toRotationMatrix();
  // Of the frame in which the scenario's vectors are given.
  Matrix3d R_BE = Matrix3d::Identity();
  if (impulse.direction && impulse.direction_frame == Frame::Inertial) R_BE = R_BN;

  double closing_speed = impulse.closing_speed;
  Vector3d r = Vector3d::Zero();  // from the target's centroid to the contact, in E
  if (!impulse.direction) {
    const double t = configuration.contact_time + scenario.time_offset;
    const TargetState state = motion->state(t);
    R_BE = R_BN * state.pose.orientation.toRotationMatrix();
    r = feature_of(problem)->point + scenario.contact_offset;
    const Vector3d velocity_N =
        state.linear_velocity + state.angular_velocity.cross(state.pose.orientation * r);
    closing_speed = velocity_N.dot(state.pose.orientation * scenario.direction);
  }
  closing_speed += scenario.closing_speed_offset;

  const Vector3d d = R_BE * scenario.direction;
  Vector6d unit;
  unit << d, (R_BE * scenario.contact_offset).cross(d);
  if (impulse.source == ImpulseSource::Given) {
    Vector6d Fbar = impulse.magnitude * unit;
    Fbar.tail<3>() += R_BE * impulse.moment;
    return Fbar;
  }
  const reference::Impact jump = response.impact(unit);
  Eigen::VectorXd x(6 + jump.Delta_phidot.size());
  x << jump.Delta_Omega, jump.Delta_phidot;
  double inverse_mass = unit.dot(Vector6d(response.dynamics.J * x)) +
                        1 / (problem.target->mass * scenario.target_mass_factor);
  if (impulse.source == ImpulseSource::RigidBody) {
    const Vector3d arm = r.cross(scenario.direction);
    inverse_mass +=
        arm.dot(problem.target->inertia.ldlt().solve(arm)) / scenario.target_inertia_factor;
  }
  if (!(closing_speed > 0)) return Vector6d::Zero();
  return (1 + scenario.restitution) * closing_speed / inverse_mass * unit;
}

double attitude_turned(const CaptureProblem& problem, const PostureResponse& response,
                       const Vector6d& Fbar, double after, const RobotModel* planned) {
  const PostImpactSpec& spec = problem.post_impact;
  const auto kind =
      spec.controllers.empty() ? std::nullopt : controller_from_name(spec.controllers.front());
  if (!kind) throw std::invalid_argument("attitude_turned needs a controller");
  const reference::Impact jump = response.impact(Fbar);
  PlantState state;
  state.phi = response.phi;
  state.Omega = jump.Delta_Omega;
  state.phidot = jump.Delta_phidot;
  SimulationOptions options = plant_options_of(spec, planned ? *planned : problem.robot);
  if (planned && !options.controller_robot) options.controller_robot = *planned;
  options.integrator = IntegratorKind::Dopri5;
  options.relative_tolerance = 1e-10;
  options.absolute_tolerance = 1e-12;
  options.horizon = after;
  options.output_period = 0;
  const SimulationResult result = simulate_post_impact(problem.robot, problem.resistance, state,
                                                       controller_of(*kind, spec), options);
  if (result.status != SimulationStatus::Finished) return kPi;
  return state.base.orientation.angularDistance(result.trace.back().state.base.orientation);
}

double objective_tolerance(const CaptureProblem& problem, double recompute_tolerance) {
  return simulates_turn(problem) ? std::max(kIntegratorsAgree, recompute_tolerance)
                                 : recompute_tolerance;
}

double term_value(const CaptureProblem& problem, const ObjectiveTerm& term,
                  const PostureResponse& response, const Vector6d& Fbar,
                  const RobotModel* planned) {
  switch (term.quantity) {
    case ObjectiveQuantity::BaseAngularMomentum:
      return (response.dynamics.Htilde_omega * (response.B * Fbar)).norm();
    case ObjectiveQuantity::BaseAngularVelocity:
      return (response.B * Fbar).norm();
    case ObjectiveQuantity::TotalAngularMomentum:
      return (response.r_gh.cross(Vector3d(Fbar.head<3>())) + Fbar.tail<3>()).norm();
    case ObjectiveQuantity::BaseMomentum: {
      Vector6d momentum =
          response.dynamics.H.topLeftCorner<6, 6>() * response.impact(Fbar).Delta_Omega;
      momentum.tail<3>() /= term.length;
      return momentum.norm();
    }
    case ObjectiveQuantity::ImpulseMagnitude:
      return Fbar.head<3>().norm();
    case ObjectiveQuantity::JointRateNorm:
      return response.impact(Fbar).Delta_phidot.norm();
    case ObjectiveQuantity::AttitudeTurned:
      return attitude_turned(problem, response, Fbar, term.after, planned);
  }
  throw std::logic_error("no such objective");
}

double objective_value(const CaptureProblem& problem, const PostureResponse& response,
                       const Vector6d& Fbar, const RobotModel* planned) {
  double sum = 0;
  for (const ObjectiveTerm& term : problem.objective) {
    sum += std::pow(term_value(problem, term, response, Fbar, planned) / term.size, 2);
  }
  return std::sqrt(sum);
}

double objective_scale(const std::vector<ObjectiveTerm>& terms, const PostureResponse& response,
                       const Vector6d& Fbar) {
  const double momentum = response.rounding_scale(Fbar);
  double sum = 0;
  for (const ObjectiveTerm& term : terms) {
    double size = momentum;
    switch (term.quantity) {
      case ObjectiveQuantity::BaseAngularMomentum:
      case ObjectiveQuantity::TotalAngularMomentum:
        break;
      case ObjectiveQuantity::BaseAngularVelocity:
        size = 3 * momentum / response.dynamics.Htilde_omega.trace();
        break;
      case ObjectiveQuantity::BaseMomentum:
      case ObjectiveQuantity::ImpulseMagnitude:
        size = Fbar.head<3>().norm();
        break;
      case ObjectiveQuantity::JointRateNorm:
        // What a force of this size may do: that of the direction may be as good as none.
        size = 0;
        for (int axis = 0; axis < 3; ++axis) {
          const Vector6d along = Fbar.head<3>().norm() * Vector6d::Unit(axis);
          size = std::max(size, response.impact(along).Delta_phidot.norm());
        }
        break;
      case ObjectiveQuantity::AttitudeTurned:
        // At the rate that the base would take up alone.
        size = std::min(kPi, 3 * momentum / response.dynamics.Htilde_omega.trace() * term.after);
        break;
    }
    sum += size * size / (term.size * term.size);
  }
  return std::sqrt(sum);
}

double sampled_measure(const CaptureProblem& problem, const TargetMotion* motion,
                       const Configuration& configuration, const PostureResponse& response) {
  std::vector<std::pair<double, double>> squares;  // |y|^2 and weight
  for (const Scenario& scenario : draw_scenarios(problem)) {
    std::optional<PostureResponse> displaced;
    if (scenario.joint_offset.size() > 0) {
      displaced = posture_response(problem, configuration.phi + scenario.joint_offset);
    }
    const PostureResponse& at = displaced ? *displaced : response;
    const Vector6d Fbar = scenario_impulse(problem, motion, configuration, at, scenario);
    squares.emplace_back(std::pow(objective_value(problem, at, Fbar), 2), scenario.weight);
  }
  // The mean of the worst share of the weight; of all of it for the expectation.
  double left = problem.measure.kind == RiskMeasure::Cvar ? 1 - problem.measure.cvar_level : 1.0;
  const double share = left;
  std::sort(squares.begin(), squares.end(), std::greater<>());
  double sum = 0;
  for (const auto& [square, weight] : squares) {
    const double taken = std::min(weight, left);
    sum += taken * square;
    left -= taken;
  }
  return std::sqrt(sum / share);
}

}  // namespace stillbase::verification
