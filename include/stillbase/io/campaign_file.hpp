// What a campaign is made of: plans and problems, seeds, trials.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace stillbase {

/// A `format: stillbase.campaign` file. Every plan is tried `trials` times for every seed, in cases
/// of `trials_per_case`; every problem is planned with every seed and the plan tried, in one case
/// each.
struct CampaignSpec {
  std::vector<std::string> plans, problems;  ///< paths relative to the file
  std::vector<std::uint64_t> seeds{1};
  int trials = 1000;
  int trials_per_case = 50;
};

/// @throws InputError with everything wrong
CampaignSpec read_campaign_spec(const std::string& text, const std::string& source);

/// One case, a line of text.
struct CampaignCase {
  std::string plan, problem;  ///< absolute path; one of them is empty
  std::string sha256;         ///< of that file
  std::uint64_t seed = 1;
  int first = 0, count = 0;  ///< trials
};
std::string case_to_text(const CampaignCase& piece);
/// @param source, line where the text stands, for messages
/// @throws InputError
CampaignCase case_from_text(const std::string& text, const std::string& source = "campaign",
                            int line = 0);

/// What a case came to, a line of text.
struct CampaignCaseResult {
  std::string plan_status;  ///< of the planner; "given" for plans
  bool verified = false;    ///< the plan passes its verification
  std::string outcomes;     ///< trial_outcomes_to_text()
};
std::string case_result_to_text(const CampaignCaseResult& result);
/// @throws InputError
CampaignCaseResult case_result_from_text(const std::string& text);

}  // namespace stillbase
