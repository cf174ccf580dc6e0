#include "planner/post_impact.hpp"

#include <stillbase/simulation/settings.hpp>

namespace stillbase {

namespace {

bool exceeds(const RobotModel& robot, const JointVectord& peaks, double Joint::*limit) {
  for (int k = 0; k < robot.n(); ++k) {
    if (peaks[k] > robot.joints[static_cast<std::size_t>(k)].*limit) return true;
  }
  return false;
}

}  // namespace

std::string post_impact_failure(const CaptureProblem& problem, const Configuration& configuration,
                                const ImpactSummary& impact, const StopCondition& stop) {
  const PostImpactSpec& spec = problem.post_impact;
  if (spec.controllers.empty()) return "";
  const auto kind = controller_from_name(spec.controllers.front());
  if (!kind) return "no controller " + spec.controllers.front();
  const PlantState before = state_at_rest(configuration.base, configuration.phi);
  SimulationOptions options = plant_options_of(spec);
  options.integrator = IntegratorKind::Dopri5;
  options.relative_tolerance = 1e-8;
  options.absolute_tolerance = 1e-10;
  options.output_period = spec.horizon;
  options.stop = stop;
  const SimulationResult result = simulate_post_impact(
      problem.robot, problem.resistance,
      state_after_impact(problem.robot, problem.resistance, before, impact.Fbar),
      controller_of(*kind, spec), options);
  const SimulationSummary& summary = result.summary;
  if (result.status != SimulationStatus::Finished) return to_string(result.status);
  for (const LimitEvent& event : summary.limits) {
    if (event.kind == LimitKind::LowerStop || event.kind == LimitKind::UpperStop) {
      return problem.robot.joints[static_cast<std::size_t>(event.joint)].name + " meets its stop";
    }
  }
  if (summary.residual_base_rate > spec.residual_base_rate_max) return "base rate";
  if (summary.attitude_turned > spec.attitude_change_max) return "turn of the base";
  if (exceeds(problem.robot, summary.peak_joint_rates, &Joint::max_velocity)) return "joint rates";
  if (exceeds(problem.robot, summary.peak_torques, &Joint::max_effort)) return "joint torques";
  return "";
}

}  // namespace stillbase
