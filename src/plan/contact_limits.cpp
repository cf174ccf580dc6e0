#include "plan/contact_limits.hpp"

#include <algorithm>

namespace stillbase {

#define STILLBASE_LEAST_VALUE(quantity, dimension, words, sentence)                       \
  {.name = #quantity,                                                                     \
   .has_several = false,                                                                  \
   .is_stated = [](const CaptureProblem& p) { return p.constraints.quantity##_min > 0; }, \
   .uncounted = (words),                                                                  \
   .loosening = "a smaller constraints." #quantity "_min"},

const std::vector<ContactLimitRow>& contact_limits() {
  using Problem = CaptureProblem;
  static const std::vector<ContactLimitRow> kRows = {
      {.name = "closing_speed",
       .has_several = false,
       .is_stated = [](const Problem&) { return true; },
       .uncounted = nullptr,
       .loosening = "a smaller constraints.closing_speed_min, a target that comes faster "
                    "(target.state)"},
      {.name = "contact_push",
       .has_several = false,
       .is_stated = [](const Problem& p) { return p.impulse.contact == ContactLaw::Sticking; },
       .uncounted = nullptr,
       .loosening = "a larger velocity of the target along the normal (target.state, "
                    "contact.hand_velocity), impact.contact 'latch'"},
      {.name = "arrival_rate_",
       .has_several = true,
       .is_stated = [](const Problem& p) { return p.hand_motion.moves(); },
       .uncounted = nullptr,
       .loosening = "a larger approach.velocity_scale, less of the motion in "
                    "contact.hand_velocity, a target that turns or comes slower (target.state)"},
      {.name = "joint_rate_",
       .has_several = true,
       .is_stated =
           [](const Problem& p) {
             return p.constraints.joint_rate_scale || p.constraints.joint_rate_max.size() > 0;
           },
       .uncounted = "joint rates",
       .loosening = "a larger constraints.joint_rate_max or joint_rate_scale"},
      // clang-format off
      STILLBASE_LEAST_VALUES(STILLBASE_LEAST_VALUE)
      // clang-format on
      {.name = "clearance_",
       .has_several = true,
       .is_stated = [](const Problem& p) { return p.constraints.clearance.has_value(); },
       .uncounted = "clearances",
       .loosening = "a smaller constraints.clearance"},
      {.name = "base_attitude_",
       .has_several = true,
       .is_stated =
           [](const Problem& p) { return p.variables.base_attitude != AttitudeFreedom::Fixed; },
       .uncounted = nullptr,
       .loosening = "a larger variables.base_attitude.max"},
      {.name = "case_",
       .has_several = true,
       .is_stated =
           [](const Problem& p) { return p.constraints.impact_case != CaseConstraint::None; },
       .uncounted = nullptr,
       .loosening = "another constraints.case"},
  };
  return kRows;
}

#undef STILLBASE_LEAST_VALUE

const ContactLimitRow* limit_of(const CaptureProblem& problem, const std::string& constraint) {
  for (const ContactLimitRow& row : contact_limits()) {
    const bool is_named =
        row.has_several ? constraint.starts_with(row.name) : constraint == row.name;
    if (is_named && row.is_stated(problem)) return &row;
  }
  return nullptr;
}

std::vector<std::string> uncounted_limits(const CaptureProblem& problem) {
  std::vector<std::string> out;
  for (const ContactLimitRow& row : contact_limits()) {
    if (row.uncounted == nullptr || !row.is_stated(problem)) continue;
    if (std::find(out.begin(), out.end(), row.uncounted) == out.end()) {
      out.emplace_back(row.uncounted);
    }
  }
  return out;
}

}  // namespace stillbase
