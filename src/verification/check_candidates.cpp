// The other solutions, and that the chosen one is among them.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/clearance.hpp"

namespace stillbase::verification {
namespace {

// Differences of what a candidate says to what is found.
struct Differences {
  double objective = 0, worst_case = 0, value = 0;
  double from_zero = 0;  // of a member of a curve of zeros
};

Differences judge(const Context& context, const Candidate& candidate) {
  const ObjectiveNumbers found = objective_numbers(context, candidate.configuration);
  // A sampled maximum is a little low: relative to itself, not to the scale. One of two
  // integrations of a motion agrees with the other to a part of the scale only.
  const bool simulates = simulates_turn(context.problem);
  const auto relative = [&](double stated, double sampled) {
    if (simulates) return relative_error(stated, sampled, found.scale);
    return std::abs(stated - sampled) / std::max(std::abs(sampled), 1e-6 * found.scale);
  };
  const bool is_worst_case = context.problem.measure.kind == RiskMeasure::WorstCase;
  Differences out{relative_error(candidate.objective, found.nominal, found.scale),
                  relative(candidate.worst_case, found.worst_case),
                  is_worst_case ? relative(candidate.value, found.measure)
                                : relative_error(candidate.value, found.measure, found.scale),
                  candidate.family < 0 ? 0 : found.nominal / found.scale};
  if (candidate.is_judged) return out;
  // The largest over some directions, the predicted one among them.
  if (candidate.worst_case >= candidate.objective && candidate.worst_case <= found.worst_case) {
    out.worst_case = 0;
  }
  out.value = relative_error(
      candidate.value, is_worst_case ? candidate.worst_case : candidate.objective, found.scale);
  return out;
}

}  // namespace

void check_candidates(const Context& context, ClaimList& claims) {
  const CaptureProblem& problem = context.problem;
  const Plan& plan = context.plan;
  const VerifyOptions& options = context.options;
  const CollisionScene scene(problem);
  const double tolerance = objective_tolerance(problem, options.recompute_tolerance);
  const double worst_tolerance = std::max(tolerance, options.worst_case_tolerance);

  Differences worst;
  double nearest = kInfinity;
  Candidate chosen;
  std::vector<std::string> hits, unsaid;
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    if (options.stop.reached()) {
      claims.not_evaluated("candidates_objective", tolerance, "1",
                           fmt::format("stopped before candidate {}", i));
      return;
    }
    const Candidate& candidate = plan.candidates[i];
    const Configuration& at = candidate.configuration;
    const Differences found = judge(context, candidate);
    worst.objective = std::max(worst.objective, found.objective);
    worst.worst_case = std::max(worst.worst_case, found.worst_case);
    worst.value = std::max(worst.value, found.value);
    worst.from_zero = std::max(worst.from_zero, found.from_zero);
    const double distance = std::max({(at.phi - plan.configuration.phi).cwiseAbs().maxCoeff(),
                                      pose_error(at.base, plan.configuration.base).largest(),
                                      std::abs(at.contact_time - plan.configuration.contact_time)});
    if (distance < nearest && at.feature == plan.configuration.feature) {
      nearest = distance;
      chosen = candidate;
    }
    if (candidate.collision_free != candidate.collision.empty()) {
      unsaid.push_back(fmt::format("candidate {}", i));
    }
    // The scene allows touch at the feature that the problem looks at.
    const bool elsewhere = !at.feature.empty() && at.feature != problem.variables.feature;
    const CaptureProblem met = elsewhere ? problem_at(problem, at) : problem;
    const auto hit = contact_hit(met, elsewhere ? CollisionScene(met) : scene, at);
    if (hit && candidate.collision_free) {
      hits.push_back(fmt::format("candidate {}: {}", i, to_string(*hit)));
    }
  }
  claims.at_most(
      "candidates_objective", worst.objective, tolerance, "1",
      fmt::format("largest relative difference over {} candidates", plan.candidates.size()));
  claims.at_most("candidates_worst_case", worst.worst_case, worst_tolerance, "1",
                 "largest relative difference to the sampled worst case over the candidates");
  claims.at_most("candidates_value", worst.value,
                 problem.measure.kind == RiskMeasure::WorstCase ? worst_tolerance : tolerance, "1",
                 "largest relative difference to the measure over the candidates");
  if (!plan.families.empty()) {
    claims.at_most("families_vanish", worst.from_zero, 1e-8, "1",
                   "largest predicted objective of a candidate that is on a curve of zeros");
  }
  claims.none_wrong("candidates_collision_free", hits,
                    "candidates said to be free of collision that touch something");
  claims.none_wrong("candidates_collision_named", unsaid,
                    "candidates whose collision is named though they are free of it, or not named");
  claims.at_most("configuration_is_candidate", nearest, 1e-9, "1",
                 "the chosen configuration from the nearest candidate");
  const auto apart = [](double stated, double again) {
    return stated == again ? 0 : std::abs(stated - again) / std::max(std::abs(again), 1e-300);
  };
  claims.at_most("candidate_repeats_objective",
                 std::max({apart(chosen.objective, plan.objective.nominal),
                           apart(chosen.worst_case, plan.objective.worst_case),
                           apart(chosen.value, plan.objective.value)}),
                 options.recompute_tolerance, "1",
                 "numbers of the chosen candidate from those of the plan's objective");

  std::vector<std::string> touching;
  if (const auto hit = contact_hit(problem, scene, plan.configuration)) {
    touching.push_back(to_string(*hit));
  }
  claims.none_wrong("contact_collision", touching,
                    "bodies that touch at the contact, hand and target at the feature excepted");
}

}  // namespace stillbase::verification
