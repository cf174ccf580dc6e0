// Why candidates that rank before the chosen one were not chosen.
#pragma once

#include <string>

#include "audit/checks.hpp"

namespace stillbase::audit {

/// Collisions of candidates, and the reasons against them.
void check_exclusions(const verification::Context& context, verification::ClaimList& claims);

/// The candidates, with the reasons against them that only the search knows; empty: there are none.
std::string exclusions_by_search(const Plan& plan);

}  // namespace stillbase::audit
