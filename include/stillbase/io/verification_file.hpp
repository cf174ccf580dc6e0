// Verification files: output of `verify` and `audit`, and the member `verification` of a plan.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <stillbase/verification/trials.hpp>
#include <stillbase/verification/verification.hpp>

namespace stillbase {

/// What trials were run.
struct TrialSetting {
  Perturbations sizes;
  std::uint64_t seed = 1;
  int first = 0;
  int wanted = -1;  ///< how many were asked for; fewer in the report: interrupted. -1: as many
};
using TrialResult = std::pair<TrialSetting, TrialReport>;

/// Text of a verdict (`format: stillbase.verification`): the checks under `claims`, and the motion
/// after the impact per controller. A number that could not be evaluated is null, and so is `pass`
/// of a check that could not be made.
/// @param content_sha256 fingerprint of the plan that was judged
/// @param trials written under `trials`; null: none were run
std::string verification_to_json(const Verification& verification,
                                 const std::string& content_sha256,
                                 const TrialResult* trials = nullptr);

/// Single outcomes of trials as one line of text: in order, numbers read back exactly.
std::string trial_outcomes_to_text(const std::vector<TrialOutcome>& outcomes);

/// @throws InputError for text that trial_outcomes_to_text() does not write
std::vector<TrialOutcome> trial_outcomes_from_text(const std::string& text);

}  // namespace stillbase
