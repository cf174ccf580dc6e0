// Verdicts as JSON: what `verify` writes, and what stands under `verification` in a plan.
#pragma once

#include <string>
#include <utility>

#include <stillbase/io/trials_file.hpp>
#include <stillbase/verification/verification.hpp>

namespace stillbase {

/// Text of a verdict (`format: stillbase.verification`): claims as they were judged, and per
/// controller what happened after the impact. A number that could not be evaluated is null.
/// @param content_sha256 fingerprint of the plan that was judged
/// @param trials what stands under `trials`; null: none were asked for
std::string verification_to_json(const Verification& verification,
                                 const std::string& content_sha256,
                                 const std::pair<TrialSetting, TrialReport>* trials = nullptr);

}  // namespace stillbase
