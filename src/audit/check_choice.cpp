// Is what a plan says of better candidates true?
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "audit/checks.hpp"
#include "audit/manifold.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// Tolerances of the choice among the candidates.
struct ChoiceOptions {
  double same_measure = 1e-6;  ///< relative: smaller differences of the measure do not count
  double same_zero = 1e-7;     ///< the same of the objective's typical size
  double same_loss = 1e-6;     ///< relative
};
constexpr ChoiceOptions kChoice;

/// The candidate at the plan's configuration; null: none.
const Candidate* chosen_candidate(const Plan& plan) {
  for (const Candidate& candidate : plan.candidates) {
    const Configuration &a = candidate.configuration, &b = plan.configuration;
    if (a.phi == b.phi && a.contact_time == b.contact_time && a.feature == b.feature &&
        a.base.position == b.base.position &&
        a.base.orientation.coeffs() == b.base.orientation.coeffs()) {
      return &candidate;
    }
  }
  return nullptr;
}

}  // namespace

void check_choice(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  const Candidate* const chosen = chosen_candidate(plan);
  if (chosen == nullptr || plan.status == PlanStatus::Limit) return;
  if (plan.choice.better < 0) return claims.not_verified("choice", "the plan does not state it");
  const double value = chosen->value;
  const double same =
      kChoice.same_measure * value + kChoice.same_zero * typical_objective(context.problem);
  double least = value;
  int excluded = 0;
  Objections objections;
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    const Candidate& other = plan.candidates[i];
    least = std::min(least, other.value);
    excluded += other.excluded.empty() ? 0 : 1;
    objections.demand(!other.excluded.empty() || other.value >= value - 2 * same,
                      fmt::format("candidate {} is better and nothing excludes it", i));
    objections.demand(other.excluded.empty() || other.value <= value + 2 * same,
                      fmt::format("candidate {} is excluded and no better", i));
  }
  objections.demand(chosen->excluded.empty(), "the chosen candidate is excluded");
  objections.demand(
      excluded == plan.choice.better,
      fmt::format("{} candidates are excluded, {} are better", excluded, plan.choice.better));
  const auto& stated = plan.choice.loss_percent;
  const double loss = 100 * (value - least) / least;
  const bool is_loss = stated && std::abs(*stated - loss) <= kChoice.same_loss * loss;
  if (least < value - 2 * same) {
    objections.demand(plan.status != PlanStatus::Optimal,
                      "stated to be optimal, but a candidate is better");
    objections.demand(stated ? is_loss : least <= 2 * same,
                      fmt::format("the loss is {:.6g} %", loss));
  } else {
    // The planner may tell values apart that are one here.
    objections.demand(!stated || is_loss || *stated <= 300 * kChoice.same_measure,
                      "there is no loss");
  }
  claims.none_wrong("choice", objections, "candidates before the chosen one, and what it costs");
}

}  // namespace stillbase::audit
