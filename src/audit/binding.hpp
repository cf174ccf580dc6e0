// The limits that decide the value of a plan, against those that are reached at its configuration.
#pragma once

#include <string>
#include <vector>

#include "audit/manifold.hpp"

namespace stillbase::audit {

struct ReachedLimit {
  NamedLimit limit;
  /// By how much |y|^2 falls, relative to itself, per unit that the limit is moved outwards.
  double multiplier = 0;
  double error = 0;  ///< of the multiplier, by the errors of the differences
  /// False: another limit may take its place, so that only a sum of their multipliers is known.
  bool is_known = false;
};

/// The limits that are reached at a configuration, without multipliers.
std::vector<ReachedLimit> limits_at(const CaptureProblem& problem, const Configuration& at);

/// The plan's list of limits that decide its value: none that is not reached, none left out, each
/// multiplier as recomputed.
/// @param objection why no multiplier is known; empty: they are
void check_binding(const verification::Context& context, const std::vector<ReachedLimit>& reached,
                   const std::string& objection, verification::ClaimList& claims);

}  // namespace stillbase::audit
