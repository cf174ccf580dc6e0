// Trials of a plan in words and units.
#pragma once

#include <string>

#include <stillbase/verification/trials.hpp>

namespace stillbase::app {

/// How many trials succeed, with the interval of the probability, and what the others fail by.
std::string success_words(const TrialReport& report);

/// That, and for each result its percentiles, its worst case, the limit that it has to keep, the
/// trial of the worst case and the input that it depends on most; several lines.
/// @param limits of the problem, which give the table a column; without controllers it is empty
std::string trial_words(const TrialReport& report, const PostImpactSpec* limits = nullptr);

}  // namespace stillbase::app
