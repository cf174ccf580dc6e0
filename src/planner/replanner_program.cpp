#include "planner/replanner_program.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/error.hpp>

#include "formulation/measures/measure.hpp"
#include "formulation/measures/residual.hpp"

namespace stillbase {

namespace {

/// @throws InputError for what a replanner does not cover
const CaptureProblem& replannable(const CaptureProblem& problem) {
  const auto refuse = [&problem](const std::string& message) {
    throw InputError({Finding{problem.source, 0, "not-replannable", message}});
  };
  if (problem.impulse.direction || !problem.target || problem.variables.feature.empty()) {
    refuse("impact.direction: is stated, so that no motion of a target decides the encounter");
  }
  if (simulates_turn(problem)) refuse("objective: a simulated quantity takes longer than updates");
  if (!problem.user.empty()) refuse("functions of the user are not known to keep a deadline");
  if (has_residual(problem)) refuse("uncertainty.residual_velocity: is not updated");
  if (problem.measure.kind == RiskMeasure::Cvar) refuse("objective.measure: cvar is not updated");
  if (problem.measure.kind == RiskMeasure::Expectation && problem.uncertainty.cone_confidence) {
    refuse("objective.measure: the samples of an expectation do not follow a cone from_covariance");
  }
  return problem;
}

}  // namespace

ReplanProgram::ReplanProgram(const CaptureProblem& problem, double most_rotation)
    : formulation_(replannable(problem)),
      lower_(parts().model.layout.lower_limit),
      upper_(parts().model.layout.upper_limit),
      row_lower_(formulation_.constraint_lower()),
      row_upper_(formulation_.constraint_upper()),
      piece_(formulation_.nominal_scenario()),
      directions_(this->problem(), formulation_, start_configuration(problem)) {
  formulation_.reserve_motion(most_rotation);
  if (problem.measure.kind == RiskMeasure::Expectation) samples_ = mean_scenarios(problem);
}

void ReplanProgram::stay_within(double distance, const JointVectord& phi) {
  const VariableLayout& layout = parts().model.layout;
  for (std::size_t i = 0; i < layout.joints.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    const double planned = phi[layout.joints[i]];
    lower_[j] = std::max(layout.lower_limit[j], planned - distance);
    upper_[j] = std::min(layout.upper_limit[j], planned + distance);
  }
}

double ReplanProgram::rotation_of(const TargetState& estimate) const {
  const CaptureModel& model = parts().model;
  return model.latest_motion->largest_rate(estimate) * model.horizon_from(estimate.time);
}

void ReplanProgram::set_estimate(const TargetState& estimate, double earliest) {
  formulation_.set_target_state(estimate);
  const VariableLayout& layout = parts().model.layout;
  if (layout.time >= 0) lower_[layout.time] = std::max(layout.lower[layout.time], earliest);
}

ReplanPoint ReplanProgram::empty_point() const {
  ReplanPoint out;
  out.x.setZero(num_variables());
  out.rows.setZero(num_rows());
  out.jacobian.setZero(num_rows(), num_variables());
  out.piece_values.setZero(kMostPieces);
  out.piece_gradients.setZero(kMostPieces, num_variables());
  return out;
}

void ReplanProgram::evaluate_rows(ReplanPoint& point) const {
  const NominalPoint here(parts().model, point.x);
  parts().evaluate_rows({parts().model, here.at, here.posture, here.impact}, point.rows,
                        &point.jacobian);
  const auto violation = [](const auto& value, const auto& lower, const auto& upper) {
    double worst = 0;
    for (Eigen::Index i = 0; i < value.size(); ++i) {
      worst = std::max({worst, lower[i] - value[i], value[i] - upper[i]});
      if (std::isnan(value[i])) return kInfinity;
    }
    return worst;
  };
  point.max_violation =
      std::max(violation(point.rows, row_lower_, row_upper_), violation(point.x, lower_, upper_));
}

double ReplanProgram::half_square(double length) const {
  const double ratio = length / formulation_.objective_unit();
  return ratio * ratio / 2;
}

void ReplanProgram::evaluate_cone(const NominalPoint& here, ReplanPoint& point) {
  constexpr double kCounting = MeasureOptions{}.counting_maximum;  // smaller maxima decide no step
  const CaptureModel& model = parts().model;
  directions_.move_to(here.impact.encounter, here.posture);
  const std::vector<ConePlace>& maxima = cone_.maxima(directions_);
  point.worst_direction = directions_.direction(maxima.front().c);
  point.worst_case = half_square(maxima.front().value);
  if (!is_worst_case()) return;
  point.measure = point.worst_case;
  point.pieces = 0;
  for (const ConePlace& place : maxima) {
    const double value = half_square(place.value);
    if (point.pieces == kMostPieces || value < kCounting * point.measure) break;
    const int k = point.pieces++;
    piece_.direction = (here.at.contact.R_EB * directions_.direction(place.c)).normalized();
    GradientRow gradient = point.piece_gradients.row(k);
    const auto impact = model.impact(here.at, here.posture, piece_);
    parts().objective(here.at, here.posture, impact, piece_, &gradient);
    point.piece_values[k] = value;
    point.piece_directions[static_cast<std::size_t>(k)] = piece_.direction;
  }
}

void ReplanProgram::evaluate_mean(const NominalPoint& here, ReplanPoint& point) const {
  const CaptureModel& model = parts().model;
  point.measure = 0;
  // The first row takes the sum, the second one each sample's gradient.
  point.piece_gradients.row(0).setZero();
  GradientRow gradient = point.piece_gradients.row(1);
  for (const Scenario& sample : samples_) {
    const auto posture = model.posture(here.at, sample);
    const auto impact = model.impact(here.at, posture, sample);
    point.measure += sample.weight * parts().objective(here.at, posture, impact, sample, &gradient);
    point.piece_gradients.row(0) += sample.weight * gradient;
  }
  point.piece_values[0] = point.measure;
}

void ReplanProgram::evaluate_measure(ReplanPoint& point) {
  const CaptureModel& model = parts().model;
  const NominalPoint here(model, point.x);
  GradientRow gradient = point.piece_gradients.row(0);
  point.nominal = parts().objective(here, &gradient);
  point.piece_values[0] = point.measure = point.nominal;
  point.piece_directions[0] = model.encounter.n;
  point.pieces = 1;
  if (!samples_.empty()) evaluate_mean(here, point);
  evaluate_cone(here, point);
}

double ReplanProgram::reported(double measure) const {
  return formulation_.objective_power().value(formulation_.objective_unit() *
                                              std::sqrt(2 * measure));
}

}  // namespace stillbase
