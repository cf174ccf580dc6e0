// The sets of checks of the search record. audit_plan() calls them in order.
#pragma once

#include "verification/checks.hpp"

namespace stillbase::audit {

using namespace verification;

/// All candidates, and that the configuration is one of them.
void check_candidates(const Context& context, ClaimList& claims);

/// The configuration that the nominal objective alone would choose; no check where none is stated.
void check_nominal_optimum(const Context& context, ClaimList& claims);

/// Points, lengths and ends of the continua of solutions; no check without any.
void check_continua(const Context& context, ClaimList& claims);

/// Configurations of the plan that are on a self-motion curve which it does not list. Of a robust
/// measure only the nominal optimum: its own minima may be on curves that no start reached.
std::vector<std::string> unlisted_curves(const Context& context);

/// The enclosed solutions and the candidates are the same; no check without a proof.
void check_proof(const Context& context, ClaimList& claims);

/// The lower bound of the measure, when it is above zero: no candidate and no configuration that a
/// search of its own finds is better.
void check_bound(const Context& context, ClaimList& claims);

/// List of the candidates, counts and status of the search, certificate.
void check_search_record(const Context& context, ClaimList& claims);

}  // namespace stillbase::audit
