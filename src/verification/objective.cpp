#include "verification/objective.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <stillbase/core/rotation.hpp>
#include <stillbase/simulation/simulate.hpp>

namespace stillbase::verification {
namespace {

/// The simulation of a rotation, and how well two integrations of a measure agree.
struct ObjectiveOptions {
  /// Errors of a step of the simulation of a rotation.
  double relative_step = 1e-10, absolute_step = 1e-12;
  /// Relative difference of two integrations: fixed steps of the planner, adaptive ones here.
  double simulated = 1e-5;
  double carried = 1e-7;       ///< the same of the errors of an estimate, carried to the contact
  std::size_t climbs = 8;      ///< compass searches, from the best samples
  double apart = 2.5;          ///< spacings of the samples between their beginnings
  double finest_climb = 1e-6;  ///< of the spacing, the last step of a search
};
constexpr ObjectiveOptions kObjective;

double rate_scale(const TermCase& at) {
  return 3 * at.response.rounding_scale(at.Fbar) / at.response.dynamics.Htilde_omega.trace();
}

double momentum_scale(const TermCase& at) { return at.response.rounding_scale(at.Fbar); }

double impulse_size(const TermCase& at) { return at.Fbar.head<3>().norm(); }

/// With a hand that moves the impulse is what is left of one that would stop the robot.
double impulse_scale(const TermCase& at) {
  const auto& before = at.response.before;
  if (!before) return impulse_size(at);
  return impulse_size(at) + at.response.dynamics.mass * before->hand.head<3>().norm();
}

double base_momentum(const TermCase& at) {
  Vector6d momentum = at.response.H_b * at.response.impact(at.Fbar).Delta_Omega;
  momentum.tail<3>() /= at.term.length;
  return momentum.norm();
}

/// Root of half the sum over the base body of mass times the square of the velocity.
double root_of_base_energy(const TermCase& at) {
  const Body& base = at.problem.robot.base;
  const Vector6d Omega = at.response.impact(at.Fbar).Delta_Omega;
  const Vector3d v = Omega.head<3>(), omega = Omega.tail<3>();
  return std::sqrt(0.5 * base.mass * v.dot(v) + 0.5 * omega.dot(base.inertia * omega));
}

/// Joint rates after an impulse of this size along the base axes: the impulse's own direction may
/// leave the joints at rest.
double joint_rate_scale(const TermCase& at) {
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector6d along = impulse_scale(at) * Vector6d::Unit(axis);
    largest = std::max(largest, at.response.impact(along).Delta_phidot.norm());
  }
  return largest;
}

/// Of the base right after the impact, rad/s.
Vector3d base_rate(const TermCase& at) {
  Vector3d omega = at.response.B * at.Fbar;
  if (at.response.before) omega += at.response.before->Omega.tail<3>();
  return omega;
}

const QuantityRecord kRecords[] = {
    {ObjectiveQuantity::BaseAngularMomentum,
     [](const TermCase& at) { return (at.response.dynamics.Htilde_omega * base_rate(at)).norm(); },
     1, momentum_scale, &reference::Impact::base},
    {ObjectiveQuantity::BaseAngularVelocity,
     [](const TermCase& at) { return base_rate(at).norm(); }, 1, rate_scale,
     &reference::Impact::base},
    {ObjectiveQuantity::TotalAngularMomentum,
     [](const TermCase& at) { return at.response.impact(at.Fbar).total.norm(); }, 1, momentum_scale,
     &reference::Impact::total},
    {ObjectiveQuantity::BaseMomentum, base_momentum, 1, impulse_scale, nullptr},
    {ObjectiveQuantity::ImpulseMagnitude, impulse_size, 1, impulse_scale, nullptr},
    {ObjectiveQuantity::JointRateNorm,
     [](const TermCase& at) { return at.response.impact(at.Fbar).Delta_phidot.norm(); }, 1,
     joint_rate_scale, nullptr},
    {ObjectiveQuantity::BaseEnergy, root_of_base_energy, 2,
     // As if the whole impulse went into the base.
     [](const TermCase& at) {
       return std::max(impulse_scale(at) / std::sqrt(2 * at.problem.robot.base.mass),
                       root_of_base_energy(at));
     },
     nullptr},
    {ObjectiveQuantity::AttitudeTurned, attitude_turned, 1,
     // At the rate that the base would have alone.
     [](const TermCase& at) { return std::min(kPi, rate_scale(at) * at.term.after); }, nullptr},
};

double raised(double size, int power) { return power == 1 ? size : std::pow(size, power); }

using Number = double (*)(const TermCase&);

double root_of_squares(const CaptureProblem& problem, const PostureResponse& response,
                       const Vector6d& Fbar, const RobotModel* planned,
                       Number QuantityRecord::*number) {
  double sum = 0;
  for (const ObjectiveTerm& term : problem.objective) {
    const QuantityRecord& record = record_of(term.quantity);
    const double size = (record.*number)({problem, term, response, Fbar, planned});
    sum += record.power == 2 ? size * size / term.size : std::pow(size / term.size, 2);
  }
  return std::sqrt(sum);
}

/// Power of the objective as a whole.
int power_of(const CaptureProblem& problem) {
  const ObjectiveTerm& first = problem.objective.front();
  const bool is_alone =
      problem.objective.size() == 1 && first.size == 1 && problem.user.terms.empty();
  return is_alone ? record_of(first.quantity).power : 1;
}

/// A direction by its angle from n and its azimuth (unused in a wedge).
struct ConePoint {
  double angle = 0, azimuth = 0;
  double value = 0;
};

}  // namespace

const QuantityRecord& record_of(ObjectiveQuantity quantity) {
  for (const QuantityRecord& record : kRecords) {
    if (record.quantity == quantity) return record;
  }
  throw std::logic_error("verification has no formula for " + to_string(quantity));
}

double attitude_turned(const TermCase& at) {
  const PostImpactSpec& spec = at.problem.post_impact;
  const auto controller = chosen_controller(spec);
  if (!controller) throw std::invalid_argument("attitude_turned needs a controller");
  const reference::Impact jump = at.response.impact(at.Fbar);
  PlantState state;
  state.phi = at.response.phi;
  state.Omega = jump.Delta_Omega;
  state.phidot = jump.Delta_phidot;
  const RobotModel& robot = at.problem.robot;
  SimulationOptions options = plant_options_of(spec, at.planned ? *at.planned : robot);
  if (at.planned && !options.controller_robot) options.controller_robot = *at.planned;
  options.integrator = IntegratorKind::Dopri5;
  options.relative_tolerance = kObjective.relative_step;
  options.absolute_tolerance = kObjective.absolute_step;
  options.horizon = at.term.after;
  options.output_period = 0;
  const SimulationResult result =
      simulate_post_impact(robot, at.problem.resistance, state, *controller, options);
  if (result.status != SimulationStatus::Finished) return kPi;
  return state.base.orientation.angularDistance(result.trace.back().state.base.orientation);
}

double term_value(const TermCase& at) {
  const QuantityRecord& record = record_of(at.term.quantity);
  return raised(record.size(at), record.power);
}

double term_scale(const TermCase& at) {
  const QuantityRecord& record = record_of(at.term.quantity);
  return raised(record.rounding_scale(at), record.power);
}

double objective_value(const CaptureProblem& problem, const PostureResponse& response,
                       const Vector6d& Fbar, const RobotModel* planned) {
  return raised(root_of_squares(problem, response, Fbar, planned, &QuantityRecord::size),
                power_of(problem));
}

double objective_scale(const CaptureProblem& problem, const PostureResponse& response,
                       const Vector6d& Fbar) {
  return raised(root_of_squares(problem, response, Fbar, nullptr, &QuantityRecord::rounding_scale),
                power_of(problem));
}

double objective_along(const Situation& situation, const Vector3d& d) {
  return objective_value(situation.problem, situation.response, situation.impulse(d));
}

double square_of(const CaptureProblem& problem, const PostureResponse& response,
                 const Vector6d& Fbar) {
  return std::pow(root_of_squares(problem, response, Fbar, nullptr, &QuantityRecord::size), 2);
}

double scale_along(const Situation& situation, const Vector3d& d) {
  return objective_scale(situation.problem, situation.response, situation.impulse(d));
}

double objective_tolerance(const CaptureProblem& problem, double recompute_tolerance) {
  const auto& residual = problem.uncertainty.residual_velocity;
  if (residual && !residual->covariance) return std::max(kObjective.carried, recompute_tolerance);
  return simulates_turn(problem) ? std::max(kObjective.simulated, recompute_tolerance)
                                 : recompute_tolerance;
}

Vector3d cone_direction(const Vector3d& n, const std::optional<Vector3d>& plane_normal,
                        double angle, double azimuth) {
  if (plane_normal) return rotation_exp(angle * *plane_normal) * n;
  const Vector3d e1 = n.unitOrthogonal(), e2 = n.cross(e1);
  return std::cos(angle) * n + std::sin(angle) * (std::cos(azimuth) * e1 + std::sin(azimuth) * e2);
}

WorstDirection worst_over_cone(const std::function<double(const Vector3d&)>& value,
                               const Vector3d& n, double half_angle,
                               const std::optional<Vector3d>& plane_normal, int samples) {
  auto direction = [&](const ConePoint& p) {
    return cone_direction(n, plane_normal, p.angle, p.azimuth);
  };
  const double lowest_angle = plane_normal ? -half_angle : 0.0;
  auto at = [&](double angle, double azimuth) {
    ConePoint p{std::clamp(angle, lowest_angle, half_angle), azimuth, 0};
    p.value = value(direction(p));
    return p;
  };

  std::vector<ConePoint> grid{at(0, 0)};
  double angle_step = half_angle, azimuth_step = 0;
  if (half_angle > 0 && plane_normal) {
    const int count = std::max(samples, 3);
    angle_step = 2 * half_angle / (count - 1);
    for (int i = 0; i < count; ++i) grid.push_back(at(-half_angle + i * angle_step, 0));
  } else if (half_angle > 0) {
    // Six times as many azimuths as rings: the spacing on the rim is that between the rings.
    const int rings = std::max(2, static_cast<int>(std::sqrt(samples / 6.0)));
    angle_step = half_angle / rings;
    azimuth_step = 2 * kPi / (6 * rings);
    for (int i = 1; i <= rings; ++i) {
      for (int j = 0; j < 6 * rings; ++j) grid.push_back(at(i * angle_step, j * azimuth_step));
    }
  }

  // Compass search in (angle, azimuth) from the best samples, each apart from the better ones, so
  // that a narrow maximum beside a wide one is found as well. In these coordinates the rim is a
  // bound on one of them, and the search slides along it.
  std::stable_sort(grid.begin(), grid.end(),
                   [](const ConePoint& a, const ConePoint& b) { return a.value > b.value; });
  std::vector<ConePoint> apart;
  for (const ConePoint& sample : grid) {
    const Vector3d d = direction(sample);
    const bool is_near = std::any_of(apart.begin(), apart.end(), [&](const ConePoint& other) {
      return (direction(other) - d).norm() < kObjective.apart * angle_step;
    });
    if (!is_near) apart.push_back(sample);
    if (apart.size() == kObjective.climbs) break;
  }
  grid = std::move(apart);
  const std::size_t kept = grid.size();
  ConePoint best = grid.front();
  for (std::size_t i = 0; i < kept && half_angle > 0; ++i) {
    ConePoint p = grid[i];
    double scale = 1;
    while (scale > kObjective.finest_climb) {
      ConePoint better = p;
      for (const double sign : {-1.0, 1.0}) {
        const ConePoint a = at(p.angle + sign * scale * angle_step, p.azimuth);
        if (a.value > better.value) better = a;
        if (azimuth_step == 0) continue;
        const ConePoint b = at(p.angle, p.azimuth + sign * scale * azimuth_step);
        if (b.value > better.value) better = b;
      }
      if (better.value > p.value) {
        p = better;
      } else {
        scale /= 2;
      }
    }
    if (p.value > best.value) best = p;
  }
  return {best.value, direction(best)};
}

WorstDirection worst_direction(const Situation& situation, int samples) {
  const UncertaintySpec& uncertainty = situation.problem.uncertainty;
  return worst_over_cone([&](const Vector3d& d) { return objective_along(situation, d); },
                         situation.event.n, uncertainty.cone_half_angle,
                         uncertainty.cone_plane_normal, samples);
}

std::vector<WeightedSquare> sampled_squares(const CaptureProblem& problem,
                                            const TargetMotion* motion,
                                            const Configuration& configuration,
                                            const PostureResponse& response) {
  std::vector<WeightedSquare> squares;
  for (const Scenario& scenario : draw_scenarios(problem)) {
    const bool is_displaced = scenario.joint_offset.size() > 0;
    PostureResponse at = is_displaced
                             ? posture_response(problem, configuration.phi + scenario.joint_offset)
                             : response;
    const Vector6d Fbar = scenario_impulse(problem, motion, configuration, at, scenario);
    squares.push_back({square_of(problem, at, Fbar), scenario.weight});
  }
  return squares;
}

double sampled_measure(const CaptureProblem& problem, const TargetMotion* motion,
                       const Configuration& configuration, const PostureResponse& response) {
  std::vector<WeightedSquare> squares = sampled_squares(problem, motion, configuration, response);
  // Mean over the largest values that have this share of the weight; 1 for the expectation.
  const double share =
      problem.measure.kind == RiskMeasure::Cvar ? 1 - problem.measure.cvar_level : 1.0;
  std::sort(squares.begin(), squares.end(), [](const WeightedSquare& a, const WeightedSquare& b) {
    return std::pair(a.square, a.weight) > std::pair(b.square, b.weight);
  });
  double left = share, sum = 0;
  for (const auto& [square, weight] : squares) {
    const double taken = std::min(weight, left);
    sum += taken * square;
    left -= taken;
  }
  return raised(std::sqrt(sum / share), power_of(problem));
}

bool is_sampled(RiskMeasure measure) {
  return measure == RiskMeasure::Expectation || measure == RiskMeasure::Cvar;
}

ResidualNumbers residual_numbers(const CaptureProblem& problem, const ResidualCase& residual) {
  const int power = power_of(problem);
  const LargestSquare largest = largest_square(residual);
  // Squares that vanish are rounding, of either sign.
  const auto of_square = [&](double square) {
    return raised(std::sqrt(std::max(square, 0.0)), power);
  };
  return {of_square(residual.mean_square()), of_square(largest.value), of_square(largest.bound)};
}

double residual_along(const CaptureProblem& problem, const ResidualCase& residual,
                      const Vector6d& V) {
  return raised(std::sqrt(std::max(residual.square(V), 0.0)), power_of(problem));
}

double measure_value(const Situation& situation, int cone_samples) {
  const RiskMeasure kind = situation.problem.measure.kind;
  if (situation.problem.uncertainty.residual_velocity && kind != RiskMeasure::Nominal) {
    const ResidualNumbers found = residual_numbers(situation.problem, residual_case(situation));
    return kind == RiskMeasure::WorstCase ? found.worst_case : found.expectation;
  }
  if (is_sampled(kind)) return sampled_measure(situation);
  if (kind == RiskMeasure::WorstCase) return worst_direction(situation, cone_samples).value;
  return objective_along(situation, situation.event.n);
}

ObjectiveNumbers objective_numbers(const Situation& situation, int cone_samples) {
  ObjectiveNumbers out;
  out.scale = scale_along(situation, situation.event.n);
  out.nominal = objective_along(situation, situation.event.n);
  if (situation.problem.uncertainty.residual_velocity) {
    const RiskMeasure kind = situation.problem.measure.kind;
    const ResidualNumbers found = residual_numbers(situation.problem, residual_case(situation));
    out.worst_case = found.worst_case;
    out.measure = kind == RiskMeasure::WorstCase     ? found.worst_case
                  : kind == RiskMeasure::Expectation ? found.expectation
                                                     : out.nominal;
    return out;
  }
  out.worst_case = worst_direction(situation, cone_samples).value;
  out.measure = situation.problem.measure.kind == RiskMeasure::WorstCase
                    ? out.worst_case
                    : measure_value(situation, cone_samples);
  return out;
}

}  // namespace stillbase::verification
