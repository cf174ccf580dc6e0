#include "planner/choice.hpp"

#include <algorithm>

#include "plan/exclusion_words.hpp"

namespace stillbase {

bool is_same_configuration(const Configuration& a, const Configuration& b) {
  return a.feature == b.feature && a.phi == b.phi && a.contact_time == b.contact_time &&
         a.base.position == b.base.position &&
         a.base.orientation.coeffs() == b.base.orientation.coeffs();
}

void state_choice(Plan& plan, double equal, double improvement) {
  std::vector<Candidate>& candidates = plan.candidates;
  const auto chosen = std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& c) {
    return is_same_configuration(c.configuration, plan.configuration);
  });
  plan.choice = {};
  plan.choice.loss_percent = 0;
  if (chosen == candidates.end()) return;
  // A sample of a self-motion stands last whatever its rank.
  const bool is_sample = chosen->starts_reached == 0 && chosen->family < 0;
  const double value = chosen->value;
  double least = value;
  for (auto other = candidates.begin(); other != candidates.end(); ++other) {
    const double difference = value - other->value;
    const double same = std::max(equal, improvement * value);
    const bool ranks_before =
        difference > same || (difference >= -same && other < chosen && !is_sample);
    if (!ranks_before) {
      other->excluded.clear();
      continue;
    }
    ++plan.choice.better;
    if (other->excluded.empty()) {
      other->excluded = plan.problem.approach.effort == ApproachEffort::First
                            ? exclusion::kFirstPathWanted
                            : exclusion::kNotTried;
    }
    if (difference > same) least = std::min(least, value - difference);
  }
  if (!(value > least)) return;
  plan.choice.loss_percent.reset();
  if (least > equal) plan.choice.loss_percent = 100 * (value - least) / least;
  if (plan.status == PlanStatus::Optimal) plan.status = PlanStatus::Feasible;
}

}  // namespace stillbase
