// Which candidate the approach leads to.
#pragma once

#include <map>
#include <optional>
#include <string>

#include <stillbase/planner/planner.hpp>
#include <stillbase/search/search.hpp>

#include "planner/candidates.hpp"

namespace stillbase {

struct ChosenApproach {
  std::size_t candidate = 0;  ///< index among those found
  Approach approach;
  /// The configuration that was found with the path, in place of that of the candidate.
  std::optional<CertifiedCandidate> certified;
  bool is_sample = false;  ///< `certified` stands beside the candidate: a sample of its self-motion
  bool holds = false;      ///< reached, and the limits of the time after the impact are kept
  /// By index of a candidate that was not chosen: why. Candidates without an entry were not tried.
  std::map<std::size_t, std::string> excluded = {};
};

/// Approaches to the candidates of a search that were judged for collisions; see make_plan for the
/// order.
/// @param encounter encounter_model() of the problem
/// @param seed of the paths
ChosenApproach choose_approach(const CaptureProblem& problem, const EncounterModel& encounter,
                               const CollisionJudge& collisions, const SearchResult& found,
                               const Proof& proof, std::uint64_t seed, AfterImpactJudge& after,
                               const PlannerOptions& options,
                               std::map<std::string, long>& solver_calls);

}  // namespace stillbase
