#include <stillbase/planner/planner.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

#include <stillbase/approach/approach.hpp>
#include <stillbase/capture/robust.hpp>
#include <stillbase/capture/search.hpp>
#include <stillbase/collision/scene.hpp>
#include <stillbase/plan/encounter.hpp>

#include "planner/completeness.hpp"
#include "planner/contact_again.hpp"
#include "planner/post_impact.hpp"

namespace stillbase {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::optional<TargetMotion> target_at(const CaptureProblem& problem,
                                      const Configuration& configuration) {
  const auto kinematics = compute_kinematics<double>(problem.robot, configuration.phi);
  return encounter_motion(problem, configuration.base * kinematics.r_bh,
                          configuration.base.orientation, configuration.contact_time);
}

/// What touches what while the robot waits at a configuration and the target comes in; empty:
/// nothing.
std::string waiting_collision(const CaptureProblem& problem, const CollisionScene& scene,
                              const Configuration& configuration) {
  const auto kinematics = compute_kinematics<double>(problem.robot, configuration.phi);
  const std::optional<TargetMotion> motion = target_at(problem, configuration);
  // The approach keeps its clearance up to the contact, so a candidate must offer it.
  const double margin = problem.approach.enabled ? problem.approach.clearance : 0;
  if (!motion) {
    const auto hit = scene.first_hit(kinematics, configuration.base, nullptr, margin);
    return hit ? to_string(*hit) : "";
  }
  // From the contact backwards, so that what is reported is what matters most.
  const double wait = problem.approach.wait;
  const double speed =
      std::max(1e-3, motion->state(configuration.contact_time).linear_velocity.norm());
  const int steps = std::clamp(static_cast<int>(std::ceil(wait * speed / 0.01)), 1, 2000);
  for (int i = 0; i <= steps; ++i) {
    const double time = configuration.contact_time - wait * i / steps;
    const Pose pose = motion->state(time).pose;
    const auto hit = scene.first_hit(kinematics, configuration.base, &pose, margin);
    if (hit) return to_string(*hit);
  }
  return "";
}

/// Whether the base's pose at the contact follows from the path instead of the search.
bool base_follows_path(const CaptureProblem& problem) {
  return problem.approach.enabled && problem.approach.base == BaseMode::Floating &&
         !problem.approach.station_free;
}

/// Whether the configuration is found together with the path.
bool path_decides(const CaptureProblem& problem) {
  const bool within_null_space = problem.approach.base == BaseMode::ReactionNull;
  return base_follows_path(problem) || (problem.approach.enabled && within_null_space);
}

/// The problem as the path leaves the base: that at the contact is not the stated one.
CaptureProblem at_contact(const CaptureProblem& problem, const Configuration& configuration) {
  CaptureProblem at = problem;
  if (base_follows_path(problem)) at.base = configuration.base;
  return at;
}

bool keeps_limits_after(const CaptureProblem& problem, const ContactAgain::Resolved& resolved,
                        const StopCondition& stop) {
  const Configuration& configuration = resolved.candidate.configuration;
  const CaptureProblem at = at_contact(problem, configuration);
  return post_impact_failure(problem, configuration,
                             predict_impact(at, Formulation(at), configuration), stop)
      .empty();
}

/// Order in which approaches are tried: candidates free of collision whose time after the impact
/// keeps the problem's limits, best first; then the other ones free of collision; when nothing is
/// free, the best alone. Where the base's pose follows from the path, what touches at the stated
/// pose says little: all are tried.
std::vector<std::size_t> candidates_to_try(const CaptureProblem& problem,
                                           const Formulation& formulation,
                                           const std::vector<Candidate>& candidates,
                                           const StopCondition& stop) {
  std::vector<std::size_t> holding, others;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!candidates[i].collision_free) continue;
    const Configuration& configuration = candidates[i].configuration;
    const bool holds =
        !stop.reached() &&
        post_impact_failure(problem, configuration,
                            predict_impact(problem, formulation, configuration), stop)
            .empty();
    (holds ? holding : others).push_back(i);
  }
  holding.insert(holding.end(), others.begin(), others.end());
  for (std::size_t i = 0; i < candidates.size() && base_follows_path(problem); ++i) {
    if (!candidates[i].collision_free) holding.push_back(i);
  }
  if (holding.empty()) holding.push_back(0);
  return holding;
}

}  // namespace

ImpactSummary predict_impact(const CaptureProblem& problem, const Formulation& formulation,
                             const Configuration& configuration) {
  const Encounter encounter = formulation.encounter(configuration);
  const ImpactResistance resistance = prepare_resistance(problem.resistance, problem.robot.n());
  const auto posture = evaluate_posture<double>(problem.robot, resistance, configuration.phi);
  const auto response = respond<double>(posture, encounter.F);
  const double p = impulse_magnitude(problem, encounter, response.hand_inverse_mass);
  return summarize_impact(problem.robot, configuration.phi, problem.resistance, p * encounter.F,
                          encounter.closing_speed);
}

Plan make_plan(const CaptureProblem& problem, const PlannerOptions& options) {
  const auto begin = Clock::now();
  const Formulation formulation(problem);
  const CollisionScene scene(problem);
  const auto progress = [&](const std::string& what, int done, int total) {
    if (options.on_progress) options.on_progress(what, done, total);
  };

  SearchOptions search_options;
  search_options.optimizer = problem.search.optimizer;
  search_options.starts = problem.search.starts;
  search_options.seed = problem.search.seed;
  search_options.max_candidates = problem.search.max_candidates;
  search_options.stop = options.stop;
  search_options.on_progress = [&](int done, int total) { progress("search", done, total); };
  SearchResult found = search(problem, formulation, search_options);

  const auto proof_begin = Clock::now();
  progress("proof", 0, 1);
  Proof proof = prove_solutions(problem, formulation, options.stop);
  match_candidates(problem, found, proof);
  const std::vector<Eigen::VectorXd> missing = missing_solutions(problem, proof);
  proof.found_by_search = static_cast<int>(proof.solutions.size() - missing.size());
  if (!missing.empty() && !options.stop.reached()) {
    search_options.more_starts = missing;
    found = search(problem, formulation, search_options);
    match_candidates(problem, found, proof);
  }
  state_what_was_missed(proof);

  Plan plan;
  plan.problem = problem;
  plan.optimizer = problem.search.optimizer;
  plan.solver_calls = found.solver_calls;
  plan.timing["search"] = std::chrono::duration<double>(proof_begin - begin).count();
  plan.timing["proof"] = seconds_since(proof_begin);

  const bool solved =
      !found.candidates.empty() && status_of(found.certificates.front()) != PlanStatus::Infeasible;
  for (Candidate& candidate : found.candidates) {
    candidate.collision = waiting_collision(problem, scene, candidate.configuration);
    candidate.collision_free = candidate.collision.empty();
  }

  const auto approach_begin = Clock::now();
  std::size_t chosen = 0;
  std::optional<ContactAgain::Resolved> resolved;
  bool fallback = false;  // an approach, though not one to a configuration that holds
  if (solved) {
    progress("after the impact", 0, 1);
    const std::vector<std::size_t> order =
        candidates_to_try(problem, formulation, found.candidates, options.stop);
    chosen = order.front();
    for (std::size_t i = 0; i < order.size() && static_cast<int>(i) < options.max_approaches; ++i) {
      if (i > 0 && options.stop.reached()) break;
      progress("approach", static_cast<int>(i), options.max_approaches);
      const Configuration& goal = found.candidates[order[i]].configuration;
      const std::optional<TargetMotion> motion = target_at(problem, goal);
      ContactAgain contact(problem, found.points[order[i]], found.candidates[order[i]],
                           found.certificates[order[i]], options.stop);
      const Approach approach =
          plan_approach(problem, goal, motion ? &*motion : nullptr, problem.search.seed + i,
                        options.stop, plan.solver_calls, contact.solver());
      if (contact.optimizer_calls() > 0) {
        plan.solver_calls[problem.search.optimizer] += contact.optimizer_calls();
      }
      const bool arrives = approach.status == ApproachStatus::Found ||
                           approach.status == ApproachStatus::NotRequested;
      std::optional<ContactAgain::Resolved> there;
      if (arrives && path_decides(problem)) {
        there = contact.resolve(approach.joint_positions.back(), approach.base_poses.back());
        Candidate& candidate = there->candidate;
        candidate.collision = waiting_collision(problem, scene, candidate.configuration);
        candidate.collision_free = candidate.collision.empty();
      }
      // A configuration that came with its path was not judged by its time after the impact yet.
      const bool holds = arrives && (!there || keeps_limits_after(problem, *there, options.stop));
      if (i == 0 || holds || (arrives && !fallback)) {
        plan.approach = approach;
        chosen = order[i];
        resolved = there;
        fallback = arrives;
      }
      if (holds) break;
    }
  }
  if (plan.approach.status == ApproachStatus::TimeOut && options.stop.is_interrupted()) {
    plan.approach.status = ApproachStatus::Interrupted;
  }
  plan.timing["approach"] = seconds_since(approach_begin);

  if (!found.candidates.empty()) {
    plan.certificate = found.certificates[chosen];
    plan.constraints = formulation.report(found.points[chosen]);
    if (resolved) {
      found.candidates[chosen] = resolved->candidate;
      plan.certificate = resolved->certificate;
      plan.constraints = resolved->constraints;
    }
    plan.certificate.proof = std::move(proof);
    const Candidate& best = found.candidates[chosen];
    plan.configuration = best.configuration;
    const CaptureProblem at = at_contact(problem, best.configuration);
    const Formulation there(at);
    plan.impact = predict_impact(at, there, best.configuration);
    plan.objective.name = objective_name(problem);
    plan.objective.unit = objective_unit_name(problem);
    plan.objective.nominal = best.objective;
    plan.objective.value = best.value;
    plan.objective.terms = objective_terms(at, there, best.configuration);
    plan.nominal_optimum = found.nominal_optimum;
    const WorstCase worst = worst_case(at, there, best.configuration);
    plan.objective.worst_case = worst.value;
    plan.objective.worst_direction = worst.direction;
    plan.status = status_of(plan.certificate);
    if (found.stopped) plan.status = PlanStatus::Limit;
  }
  plan.candidates = std::move(found.candidates);
  plan.timing["total"] = seconds_since(begin);
  return plan;
}

}  // namespace stillbase
