// A plan in words and units.
#pragma once

#include <string>

#include <stillbase/plan/plan.hpp>

namespace stillbase::app {

/// What was asked, what was found, what it costs: about a dozen lines without a newline at the end.
std::string plan_summary(const Plan& plan);

}  // namespace stillbase::app
