// The candidates, the chosen one among them, and the nominal optimum.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/plan/free_roll.hpp>

#include "audit/checks.hpp"
#include "audit/tolerances.hpp"
#include "verification/clearance.hpp"
#include "verification/tolerances.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// Tolerances of the nominal optimum.
struct NominalOptimumOptions {
  double above_lowest = 1e-6;  ///< of the scale: minima of two solves that are one
};
constexpr NominalOptimumOptions kNominalOptimum;

/// Differences of a candidate's stated numbers from the recomputed ones.
struct Differences {
  double objective = 0, worst_case = 0, value = 0;
  double from_zero = 0;  ///< of a member of a curve of zeros

  void include(const Differences& other) {
    objective = std::max(objective, other.objective);
    worst_case = std::max(worst_case, other.worst_case);
    value = std::max(value, other.value);
    from_zero = std::max(from_zero, other.from_zero);
  }
};

/// A curve along which a joint is free has one value, which need not be zero.
bool is_on_zeros(const Context& context, const Candidate& candidate) {
  return candidate.family >= 0 &&
         !free_joint(context.plan.families[static_cast<std::size_t>(candidate.family)]);
}

Differences differences(const Context& context, const Situation& at, const Candidate& candidate) {
  const ObjectiveNumbers found = objective_numbers(at, context.cone_samples());
  // A sampled maximum is slightly low: relative to itself, not to the scale. Two integrations of a
  // motion agree to a part of the scale only, and so do two sums without a maximum.
  const bool is_sampled =
      context.problem.uncertainty.cone_half_angle > 0 && !simulates_turn(context.problem);
  const auto relative = [&](double stated, double sampled) {
    if (!is_sampled) return relative_error(stated, sampled, found.scale);
    return std::abs(stated - sampled) /
           std::max(std::abs(sampled), kShared.least_worst_case * found.scale);
  };
  const bool is_worst_case = context.problem.measure.kind == RiskMeasure::WorstCase;
  Differences out{relative_error(candidate.objective, found.nominal, found.scale),
                  relative(candidate.worst_case, found.worst_case),
                  is_worst_case ? relative(candidate.value, found.measure)
                                : relative_error(candidate.value, found.measure, found.scale),
                  is_on_zeros(context, candidate) ? found.nominal / found.scale : 0};
  if (candidate.is_judged) return out;
  // The largest over some directions, the nominal one among them.
  if (candidate.worst_case >= candidate.objective && candidate.worst_case <= found.worst_case) {
    out.worst_case = 0;
  }
  out.value = relative_error(
      candidate.value, is_worst_case ? candidate.worst_case : candidate.objective, found.scale);
  return out;
}

double worst_case_tolerance(const Context& context) {
  return std::max(context.objective_tolerance(), context.options.worst_case_tolerance);
}

double measure_tolerance(const Context& context) {
  return context.problem.measure.kind == RiskMeasure::WorstCase ? worst_case_tolerance(context)
                                                                : context.objective_tolerance();
}

/// Largest difference of joints (rad), base pose (m, rad) and time (s); infinite for other
/// features.
double distance(const Configuration& a, const Configuration& b) {
  if (a.feature != b.feature) return kInfinity;
  return std::max({(a.phi - b.phi).cwiseAbs().maxCoeff(), pose_error(a.base, b.base).largest(),
                   std::abs(a.contact_time - b.contact_time)});
}

void check_chosen(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  double nearest = kInfinity;
  Candidate chosen;
  for (const Candidate& candidate : plan.candidates) {
    const double here = distance(candidate.configuration, plan.configuration);
    if (!(here < nearest)) continue;
    nearest = here;
    chosen = candidate;
  }
  claims.at_most("configuration_is_candidate", nearest, kShared.rounding, "1",
                 "the chosen configuration from the nearest candidate");
  const auto apart = [](double stated, double repeated) {
    if (stated == repeated) return 0.0;
    return std::abs(stated - repeated) / std::max(std::abs(repeated), 1e-300);
  };
  claims.at_most("candidate_repeats_objective",
                 std::max({apart(chosen.objective, plan.objective.nominal),
                           apart(chosen.worst_case, plan.objective.worst_case),
                           apart(chosen.value, plan.objective.value)}),
                 context.options.recompute_tolerance, "1",
                 "numbers of the chosen candidate from those of the plan's objective");
}

}  // namespace

void check_candidates(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  const CollisionScene scene(context.problem);
  Differences worst;
  Objections collisions, unnamed, forbidden;
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    if (context.options.stop.reached()) {
      claims.not_evaluated("candidates_objective", context.objective_tolerance(), "1",
                           fmt::format("stopped before candidate {}", i));
      return;
    }
    const Candidate& candidate = plan.candidates[i];
    const std::string name = fmt::format("candidate {}", i);
    const Situation at(context.problem, candidate.configuration);
    worst.include(differences(context, at, candidate));
    for (const std::string& objection : configuration_objections(at, context.options)) {
      forbidden.add(fmt::format("{}: {}", name, objection));
    }
    forbidden.demand(candidate.max_violation >= 0 &&
                         candidate.max_violation <= context.options.constraint_tolerance,
                     name + ": stated violation");
    unnamed.demand(candidate.collision_free == candidate.collision.empty(), name);
    if (!candidate.collision_free) continue;
    // The scene allows contact at the feature of its problem only.
    const bool is_same_feature = at.problem.variables.feature == context.problem.variables.feature;
    const auto pair =
        contact_collision(at.problem, is_same_feature ? scene : CollisionScene(at.problem), at.at);
    if (pair) collisions.add(name + ": " + to_string(*pair));
  }
  claims.at_most(
      "candidates_objective", worst.objective, context.objective_tolerance(), "1",
      fmt::format("largest relative difference over {} candidates", plan.candidates.size()));
  claims.at_most("candidates_worst_case", worst.worst_case, worst_case_tolerance(context), "1",
                 "largest relative difference to the sampled worst case over the candidates");
  claims.at_most("candidates_value", worst.value, measure_tolerance(context), "1",
                 "largest relative difference to the measure over the candidates");
  if (!plan.families.empty()) {
    claims.at_most("families_vanish", worst.from_zero, kRecord.zero, "1",
                   "largest nominal objective of a candidate on a continuum of zeros");
  }
  claims.none_wrong("candidates_allowed", forbidden, "candidates that the problem does not allow");
  claims.none_wrong("candidates_collision_free", collisions,
                    "candidates stated to be free of collision with bodies in contact");
  claims.none_wrong("candidates_collision_named", unnamed,
                    "candidates whose collision is named though they are free of it, or not named");
  check_chosen(context, claims);
}

void check_nominal_optimum(const Context& context, ClaimList& claims) {
  const bool is_cut = context.plan.status == PlanStatus::Limit;
  Objections missing;
  missing.demand(is_cut || context.plan.nominal_optimum.has_value(),
                 "none, and no limit came first");
  claims.none_wrong("nominal_optimum_stated", missing, "the plan states its nominal optimum");
  if (!context.plan.nominal_optimum) return;
  const NominalOptimum& stated = *context.plan.nominal_optimum;
  const Situation at(context.problem, stated.configuration);
  const ObjectiveNumbers found = objective_numbers(at, context.cone_samples());
  Objections forbidden;
  for (const std::string& objection : configuration_objections(at, context.options)) {
    forbidden.add(objection);
  }
  claims.none_wrong("nominal_optimum_allowed", forbidden, "what the problem does not allow there");
  claims.same("nominal_optimum_nominal", relative_error(stated.nominal, found.nominal, found.scale),
              context.objective_tolerance(), fmt::format("{:.9g}", found.nominal));
  claims.same("nominal_optimum_worst_case",
              relative_error(stated.worst_case, found.worst_case, found.scale),
              worst_case_tolerance(context), fmt::format("{:.9g}", found.worst_case));
  claims.same("nominal_optimum_value", relative_error(stated.value, found.measure, found.scale),
              measure_tolerance(context), fmt::format("{:.9g} of the measure", found.measure));
  double lowest = context.plan.objective.nominal;
  for (const Candidate& candidate : context.plan.candidates) {
    lowest = std::min(lowest, candidate.objective);
  }
  claims.at_most("nominal_optimum_is_lowest",
                 (found.nominal - lowest) / std::max(found.scale, 1e-300),
                 kNominalOptimum.above_lowest, "1",
                 "its nominal value above that of the candidates, relative to the scale");
}

}  // namespace stillbase::audit
