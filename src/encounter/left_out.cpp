#include <stillbase/encounter/left_out.hpp>

#include <utility>

#include <fmt/format.h>

#include <stillbase/encounter/direction_cone.hpp>

namespace stillbase {

namespace {

void add_unused_covariance(const CaptureProblem& problem, std::vector<LeftOut>& out) {
  const ContactLaw law = problem.impulse.contact;
  const bool is_known = problem.target && problem.target_deviations && !problem.impulse.direction &&
                        !problem.variables.feature.empty() &&
                        problem.impulse.source != ImpulseSource::Given;
  if (!is_known || law == ContactLaw::Frictionless || problem.uncertainty.residual_velocity) return;
  const char* const advice = problem.hand_motion.moves()
                                 ? "of a hand that moves there is no measure over it"
                                 : "state uncertainty.residual_velocity: from_covariance";
  out.push_back(
      {kUnusedCovarianceRule, "target", "state.covariance",
       fmt::format("the impulse of this contact follows from the whole relative velocity, which "
                   "counts as exactly known; the covariance is drawn by trials alone; {}",
                   advice)});
}

/// The mean over the residual velocity is a closed form.
void add_not_in_measure(const CaptureProblem& problem, std::vector<LeftOut>& out) {
  const UncertaintySpec& spread = problem.uncertainty;
  if (!spread.residual_velocity || problem.measure.kind != RiskMeasure::Expectation) return;
  const JointVectord& joints = spread.joint_position;
  const std::pair<const char*, bool> half_ranges[] = {
      {"restitution", spread.restitution > 0},
      {"target_mass", spread.target_mass > 0},
      {"target_inertia", spread.target_inertia > 0},
      {"contact_point", spread.contact_point > 0},
      {"joint_position", joints.size() > 0 && joints.maxCoeff() > 0},
      {"contact_time", spread.contact_time > 0}};
  for (const auto& [key, is_stated] : half_ranges) {
    if (!is_stated) continue;
    out.push_back({kNotInMeasureRule, "uncertainty", key,
                   "is drawn by trials alone: over residual_velocity 'expectation' is a closed "
                   "form of the velocity's error; leave residual_velocity out for a mean over "
                   "samples of it"});
  }
  const MeasureSpec unstated;
  const std::pair<const char*, bool> samples[] = {
      {"samples", problem.measure.samples != unstated.samples},
      {"sample_seed", problem.measure.seed != unstated.seed}};
  for (const auto& [key, is_stated] : samples) {
    if (!is_stated) continue;
    out.push_back({kNotInMeasureRule, "objective", key,
                   "is not used: over uncertainty.residual_velocity 'expectation' is a closed form "
                   "without samples"});
  }
}

}  // namespace

std::vector<LeftOut> left_out(const CaptureProblem& problem) {
  std::vector<LeftOut> out;
  if (const auto narrow = narrow_cone(problem)) {
    out.push_back({kNarrowConeRule, "uncertainty", "cone_half_angle", to_string(*narrow)});
  }
  add_unused_covariance(problem, out);
  add_not_in_measure(problem, out);
  return out;
}

}  // namespace stillbase
