// Verdicts as JSON: output of `verify` and `audit`, and the member `verification` of a plan.
#pragma once

#include <string>
#include <utility>

#include <stillbase/io/trials_file.hpp>
#include <stillbase/verification/verification.hpp>

namespace stillbase {

/// Text of a verdict (`format: stillbase.verification`): the checks under `claims`, and the motion
/// after the impact per controller. A number that could not be evaluated is null, and so is `pass`
/// of a check that could not be made.
/// @param content_sha256 fingerprint of the plan that was judged
/// @param trials written under `trials`; null: none were run
std::string verification_to_json(const Verification& verification,
                                 const std::string& content_sha256,
                                 const std::pair<TrialSetting, TrialReport>* trials = nullptr);

}  // namespace stillbase
