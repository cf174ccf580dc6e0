#include "formulation/objectives/attitude_turned.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/error.hpp>

namespace stillbase {

namespace {

constexpr double kLargestStep = 0.01;  ///< s

Controller first_controller(const CaptureProblem& problem) {
  const auto controller = chosen_controller(problem.post_impact);
  if (!controller) {
    throw InputError({{problem.source, 0, "missing-key",
                       "objective: attitude_turned needs post_impact.controllers"}});
  }
  return *controller;
}

}  // namespace

AttitudeTurned::AttitudeTurned(const CaptureProblem& problem, const ObjectiveTerm& term)
    : robot_(problem.robot),
      resistance_(problem.resistance),
      controller_(first_controller(problem)),
      options_(plant_options_of(problem.post_impact, problem.robot)),
      size_(term.size) {
  if (!(term.after > 0)) {
    throw InputError({{problem.source, 0, "missing-key",
                       "objective: attitude_turned needs its time, after > 0"}});
  }
  options_.integrator = IntegratorKind::Rk4;
  options_.step = kLargestStep;
  options_.horizon = term.after;
  options_.output_period = 0;
}

Vector3d AttitudeTurned::operator()(const JointVectord& phi, const Vector6d& Delta_Omega,
                                    const JointVectord& Delta_phidot,
                                    const StopCondition& stop) const {
  const Vector3d broken = kPi / size_ * Vector3d::UnitX();
  // No gravity and no sensor of the attitude: the rotation is the same from every attitude.
  PlantState state = state_at_rest(Pose{}, phi);
  state.Omega = Delta_Omega;
  state.phidot = Delta_phidot;
  if (!phi.allFinite() || !Delta_Omega.allFinite() || !Delta_phidot.allFinite()) return broken;
  SimulationOptions options = options_;
  options.stop = stop;
  const SimulationResult result =
      simulate_post_impact(robot_, resistance_, state, controller_, options);
  const bool is_given_up = result.status == SimulationStatus::Interrupted ||
                           result.status == SimulationStatus::TimeLimit;
  if (is_given_up) return Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  if (result.status != SimulationStatus::Finished) return broken;
  return rotation_log(result.trace.back().state.base.orientation) / size_;
}

std::vector<AttitudeTurned> simulated_terms(const CaptureProblem& problem) {
  std::vector<AttitudeTurned> out;
  for (const ObjectiveTerm& term : problem.objective) {
    if (row_of(term.quantity).is_simulated()) out.emplace_back(problem, term);
  }
  return out;
}

}  // namespace stillbase
