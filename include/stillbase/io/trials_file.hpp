// Trials as JSON: single outcomes, which a campaign keeps, and their statistics.
#pragma once

#include <string>
#include <vector>

#include <stillbase/verification/trials.hpp>

namespace stillbase {

/// What trials were run.
struct TrialSetting {
  Perturbations sizes;
  std::uint64_t seed = 1;
  int first = 0;
  int wanted = -1;  ///< how many were asked for; fewer in the report: interrupted. -1: as many
};

/// One line of text: outcomes in order, numbers read back exactly.
std::string trial_outcomes_to_text(const std::vector<TrialOutcome>& outcomes);

/// @throws InputError for text that trial_outcomes_to_text() does not write
std::vector<TrialOutcome> trial_outcomes_from_text(const std::string& text);

/// The object that stands under `trials` in a verdict and in the result of a campaign.
std::string trial_report_to_json(const TrialSetting& setting, const TrialReport& report);

}  // namespace stillbase
