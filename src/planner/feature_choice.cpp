#include "planner/feature_choice.hpp"

#include <algorithm>
#include <optional>

#include "planner/self_motion.hpp"

namespace stillbase {

namespace {

double rank_of(const Plan& plan) {
  return plan.problem.measure.kind == RiskMeasure::Nominal ? plan.objective.worst_case
                                                           : plan.objective.value;
}

bool is_better(const PlanOfFeature& a, const PlanOfFeature& b) {
  if (a.quality != b.quality) return a.quality > b.quality;
  if (a.quality == PlanQuality::Nothing) {
    return a.plan.certificate.max_violation < b.plan.certificate.max_violation;
  }
  return rank_of(a.plan) < rank_of(b.plan);
}

/// The lower nominal value; among equal ones (exact zeros) the smaller worst case.
bool is_better(const NominalOptimum& a, const NominalOptimum& b) {
  const double equal = 1e-8 * std::max(a.worst_case, b.worst_case);
  if (std::abs(a.nominal - b.nominal) > equal) return a.nominal < b.nominal;
  return a.worst_case < b.worst_case;
}

bool is_same(const Configuration& a, const Configuration& b) {
  return a.feature == b.feature && a.phi == b.phi && a.contact_time == b.contact_time &&
         a.base.position == b.base.position &&
         a.base.orientation.coeffs() == b.base.orientation.coeffs();
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
  const auto best = std::min_element(plans.begin(), plans.end(),
                                     [](const auto& a, const auto& b) { return is_better(a, b); });
  Plan out = best->plan;
  const bool solved = best->quality != PlanQuality::Nothing;
  const std::optional<Candidate> sample = solved ? take_sample(out.candidates) : std::nullopt;
  double reached = starts_reached(out);
  double unseen = reached * out.certificate.unseen;
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
      if (candidate.family >= 0) candidate.family += static_cast<int>(out.families.size());
    }
    out.families.insert(out.families.end(), plan.families.begin(), plan.families.end());
    out.candidates.insert(out.candidates.end(), found.begin(), found.end());
    reached += starts_reached(plan);
    unseen += starts_reached(plan) * plan.certificate.unseen;
    if (plan.nominal_optimum &&
        (!out.nominal_optimum || is_better(*plan.nominal_optimum, *out.nominal_optimum))) {
      out.nominal_optimum = plan.nominal_optimum;
    }
  }
  std::stable_sort(out.candidates.begin(), out.candidates.end(),
                   [&out](const Candidate& a, const Candidate& b) {
                     return rank_of(out.problem, a) < rank_of(out.problem, b);
                   });
  const auto most = static_cast<std::size_t>(out.problem.search.max_candidates);
  if (out.candidates.size() > most) {
    const auto chosen = std::find_if(
        out.candidates.begin(), out.candidates.end(),
        [&out](const Candidate& c) { return is_same(c.configuration, out.configuration); });
    if (chosen != out.candidates.end() &&
        chosen - out.candidates.begin() >= static_cast<std::ptrdiff_t>(most)) {
      out.candidates[most - 1] = *chosen;
    }
    out.candidates.resize(most);
  }
  if (sample) out.candidates.push_back(*sample);
  if (reached > 0) out.certificate.unseen = unseen / reached;
  out.certificate.proof = {};
  out.certificate.proof.statement = "no proof: there are several contact features";
  return out;
}

}  // namespace stillbase
