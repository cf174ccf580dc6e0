// What to change in a problem for which no configuration or no path to one was found.
#pragma once

#include <string>

#include <stillbase/plan/plan.hpp>

namespace stillbase::app {

/// Changes that most likely help a search that found nothing: of what the nearest attempt violates,
/// the most violated first, and of what is not free.
std::string search_advice(const Plan& plan);

/// Changes that most likely help where the plan has no approach path.
std::string approach_advice(const Plan& plan);

}  // namespace stillbase::app
