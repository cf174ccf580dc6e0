// A plan in words and units.
#pragma once

#include <string>
#include <vector>

#include <stillbase/plan/plan.hpp>

namespace stillbase::app {

/// One line: "approach" and what there is to say about it. A continued line has an empty topic.
struct SummaryLine {
  std::string topic, words;
};

/// What was asked, what was found and how good it is, what to check.
/// @param is_verbose also what does not apply to this problem
std::vector<SummaryLine> plan_summary(const Plan& plan, bool is_verbose);

/// The lines as text, without a newline at the end.
std::string summary_text(const std::vector<SummaryLine>& lines);

}  // namespace stillbase::app
