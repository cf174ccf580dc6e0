#include "planner/feature_choice.hpp"

#include <algorithm>
#include <optional>

#include <stillbase/plan/free_roll.hpp>
#include <stillbase/search/search.hpp>

#include "plan/exclusion_words.hpp"
#include "planner/choice.hpp"
#include "planner/self_motion.hpp"
#include "search/ranking.hpp"

namespace stillbase {

namespace {

/// Of the plans of the highest quality the one whose configuration is first in order. Without any
/// configuration: the one that violates the least.
/// @param equal as in candidate_order()
std::size_t best_of(const std::vector<PlanOfFeature>& plans, double equal) {
  const auto& highest = *std::max_element(
      plans.begin(), plans.end(),
      [](const PlanOfFeature& a, const PlanOfFeature& b) { return a.quality < b.quality; });
  std::vector<std::size_t> indices;
  std::vector<Candidate> chosen;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    if (plans[i].quality != highest.quality) continue;
    indices.push_back(i);
    const ObjectiveValue& objective = plans[i].plan.objective;
    Candidate& candidate = chosen.emplace_back();
    candidate.configuration = plans[i].plan.configuration;
    candidate.objective = objective.nominal;
    candidate.worst_case = objective.worst_case;
    candidate.value = objective.value;
  }
  if (highest.quality == PlanQuality::Nothing) {
    return *std::min_element(indices.begin(), indices.end(), [&](std::size_t a, std::size_t b) {
      return plans[a].plan.certificate.max_violation < plans[b].plan.certificate.max_violation;
    });
  }
  return indices[candidate_order(plans.front().plan.problem, chosen, equal).front()];
}

/// The lower nominal value; among equal ones (exact zeros) the smaller worst case.
bool is_better(const NominalOptimum& a, const NominalOptimum& b) {
  const double equal = 1e-8 * std::max(a.worst_case, b.worst_case);
  if (std::abs(a.nominal - b.nominal) > equal) return a.nominal < b.nominal;
  return a.worst_case < b.worst_case;
}

/// What kept the plan of a feature from being chosen.
std::string failure_of(const PlanOfFeature& one) {
  if (one.quality == PlanQuality::Solved) {
    return exclusion::kNoPathOfFeature + to_string(one.plan.approach.status);
  }
  if (one.quality == PlanQuality::Arrives) {
    return exclusion::kLimitOfFeature;
  }
  return exclusion::kNotTried;
}

/// How many starts ended at the candidates of a plan.
int starts_reached(const Plan& plan) {
  int reached = 0;
  for (const Candidate& candidate : plan.candidates) reached += candidate.starts_reached;
  return reached;
}

/// Takes out the sample of a self-motion, which stands behind what the search found.
std::optional<Candidate> take_sample(std::vector<Candidate>& candidates) {
  if (candidates.empty()) return std::nullopt;
  if (candidates.back().starts_reached > 0 || candidates.back().family >= 0) return std::nullopt;
  const Candidate sample = candidates.back();
  candidates.pop_back();
  return sample;
}

}  // namespace

Plan best_of_features(std::vector<PlanOfFeature> plans) {
  double equal = kInfinity;
  for (const PlanOfFeature& one : plans) equal = std::min(equal, one.equal);
  const auto best = plans.begin() + static_cast<std::ptrdiff_t>(best_of(plans, equal));
  Plan out = best->plan;
  const bool solved = best->quality != PlanQuality::Nothing;
  const std::optional<Candidate> sample = solved ? take_sample(out.candidates) : std::nullopt;
  double reached = starts_reached(out);
  double unseen = reached * out.certificate.unseen;
  double missed = out.certificate.unseen;
  for (auto other = plans.begin(); other != plans.end(); ++other) {
    if (other == best) continue;
    const Plan& plan = other->plan;
    for (const auto& [name, calls] : plan.solver_calls) out.solver_calls[name] += calls;
    for (const auto& [name, seconds] : plan.timing) out.timing[name] += seconds;
    out.certificate.starts += plan.certificate.starts;
    if (plan.status == PlanStatus::Limit) out.status = PlanStatus::Limit;
    if (other->quality == PlanQuality::Nothing || !solved) continue;
    out.certificate.distinct_solutions += plan.certificate.distinct_solutions;
    std::vector<Candidate> found = plan.candidates;
    take_sample(found);
    for (Candidate& candidate : found) {
      if (candidate.excluded.empty()) candidate.excluded = failure_of(*other);
      if (candidate.family >= 0) candidate.family += static_cast<int>(out.families.size());
    }
    out.families.insert(out.families.end(), plan.families.begin(), plan.families.end());
    out.candidates.insert(out.candidates.end(), found.begin(), found.end());
    reached += starts_reached(plan);
    unseen += starts_reached(plan) * plan.certificate.unseen;
    missed = std::max(missed, plan.certificate.unseen);
    if (plan.nominal_optimum &&
        (!out.nominal_optimum || is_better(*plan.nominal_optimum, *out.nominal_optimum))) {
      out.nominal_optimum = plan.nominal_optimum;
    }
  }
  std::vector<Candidate> ordered;
  for (const std::size_t i : candidate_order(out.problem, out.candidates, equal)) {
    ordered.push_back(out.candidates[i]);
  }
  out.candidates = std::move(ordered);
  const auto most = static_cast<std::size_t>(out.problem.search.max_candidates);
  if (out.candidates.size() > most) {
    const auto chosen =
        std::find_if(out.candidates.begin(), out.candidates.end(), [&out](const Candidate& c) {
          return is_same_configuration(c.configuration, out.configuration);
        });
    if (chosen != out.candidates.end() &&
        chosen - out.candidates.begin() >= static_cast<std::ptrdiff_t>(most)) {
      out.candidates[most - 1] = *chosen;
    }
    out.candidates.resize(most);
  }
  drop_unlisted_rolls(out.candidates, out.families);
  if (sample) out.candidates.push_back(*sample);
  if (out.certificate.had_rounds) {
    // A better minimum may have been missed on either feature.
    out.certificate.unseen = missed;
    const bool is_above = missed > kUnseenLevel;
    if (out.status == PlanStatus::Optimal && is_above) out.status = PlanStatus::Feasible;
  } else if (reached > 0) {
    out.certificate.unseen = unseen / reached;
  }
  out.certificate.proof = {};
  out.certificate.proof.statement = "no proof: there are several contact features";
  if (solved) state_choice(out, equal, PlannerOptions{}.improvement);
  return out;
}

}  // namespace stillbase
