#include "planner/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/nlp/certificate.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "formulation/measures/measure.hpp"

namespace stillbase {

namespace {

/// Which bodies touch while the robot waits at a configuration and the target comes in; empty:
/// none.
std::string waiting_collision(const CaptureProblem& problem, const CollisionScene& scene,
                              const Configuration& configuration) {
  const auto kinematics = compute_kinematics<double>(problem.robot, configuration.phi);
  const std::optional<TargetMotion> motion = encounter_motion(problem, configuration);
  // The approach keeps its clearance up to the contact, so a candidate must offer it.
  const double margin = problem.approach.enabled ? problem.approach.clearance : 0;
  if (!motion) {
    const auto hit = scene.first_hit(kinematics, configuration.base, nullptr, margin);
    return hit ? to_string(*hit) : "";
  }
  // From the contact backwards: what is reported is the collision nearest to it.
  const double wait = problem.approach.wait;
  const double speed =
      std::max(1e-3, motion->state(configuration.contact_time).linear_velocity.norm());
  const int steps = static_cast<int>(std::clamp(std::ceil(wait * speed / 0.01), 1.0, 2000.0));
  for (int i = 0; i <= steps; ++i) {
    const double time = configuration.contact_time - wait * i / steps;
    const Pose pose = motion->state(time).pose;
    const auto hit = scene.first_hit(kinematics, configuration.base, &pose, margin);
    if (hit) return to_string(*hit);
  }
  return "";
}

}  // namespace

void judge_collisions(const CaptureProblem& problem, const CollisionScene& scene,
                      Candidate& candidate) {
  candidate.collision = waiting_collision(problem, scene, candidate.configuration);
  candidate.collision_free = candidate.collision.empty();
}

bool base_follows_path(const CaptureProblem& problem) {
  return problem.approach.enabled && problem.approach.base == BaseMode::Floating &&
         !problem.approach.station_free;
}

bool path_decides(const CaptureProblem& problem) {
  const bool within_null_space = problem.approach.base == BaseMode::ReactionNull;
  return base_follows_path(problem) || (problem.approach.enabled && within_null_space);
}

CaptureProblem at_contact(const CaptureProblem& problem, const Configuration& configuration) {
  CaptureProblem at = problem;
  if (base_follows_path(problem)) at.base = configuration.base;
  return at;
}

bool keeps_limits_after(const CaptureProblem& problem, const Configuration& configuration,
                        const StopCondition& stop) {
  return post_impact_failure(problem, configuration, impact_at(problem, configuration), stop)
      .empty();
}

CandidateOrder candidates_to_try(const CaptureProblem& problem,
                                 const std::vector<Candidate>& candidates,
                                 const StopCondition& stop) {
  const EncounterModel model = encounter_model(problem);
  CandidateOrder out;
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!candidates[i].collision_free) {
      out.excluded[i] = "at the contact: " + candidates[i].collision;
      continue;
    }
    const Configuration& at = candidates[i].configuration;
    const auto impact = impact_at(problem, model, encounter_at(model, at), at.phi);
    const std::string failure =
        stop.reached() ? "not judged" : post_impact_failure(problem, at, impact, stop);
    if (!failure.empty()) out.excluded[i] = "after the impact: " + failure;
    (failure.empty() ? out.order : others).push_back(i);
  }
  out.holding = out.order.size();
  out.order.insert(out.order.end(), others.begin(), others.end());
  for (std::size_t i = 0; i < candidates.size() && base_follows_path(problem); ++i) {
    if (!candidates[i].collision_free) out.order.push_back(i);
  }
  if (out.order.empty()) out.order.push_back(0);
  return out;
}

CertifiedCandidate certify_candidate(const CaptureProblem& problem, const Eigen::VectorXd& x,
                                     const Candidate& candidate, const Certificate& certificate) {
  const Formulation formulation(problem);
  Measure measure(problem, formulation);
  CertifiedCandidate out{candidate, certificate, formulation.report(x)};
  out.candidate.configuration = formulation.configuration(x);
  out.candidate.objective = nominal_value(problem, formulation, out.candidate.configuration);
  out.candidate.worst_case = worst_case(problem, formulation, out.candidate.configuration).value;
  out.candidate.value = measure.reported(x);
  out.candidate.max_violation = 0;
  for (const ConstraintValue& value : out.constraints) {
    out.candidate.max_violation = std::max(out.candidate.max_violation, value.violation);
  }
  out.certificate.max_violation = out.candidate.max_violation;
  const nlp::Certificate kkt = measure.certify(x);
  out.certificate.kkt_residual = kkt.kkt_residual;
  out.certificate.reduced_hessian_min_eigenvalue = kkt.reduced_hessian_min_eigenvalue;
  return out;
}

}  // namespace stillbase
