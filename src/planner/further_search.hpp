// Further searches where no candidate keeps the limits after the impact.
#pragma once

#include <map>
#include <string>

#include <stillbase/planner/planner.hpp>
#include <stillbase/search/search.hpp>

#include "planner/candidates.hpp"

namespace stillbase {

/// Adds candidates that touch nothing and keep the limits after the impact where the search has
/// found none: from other draws, every other time with limits of the joints' rates right after the
/// impact and distances from their stops as constraints. Nothing happens when a candidate holds,
/// without controllers, and where the path decides on the configuration.
/// Curves of zeros and free rolls are stated of these as of the others.
/// @param formulation of the problem
/// @param found of `search_options`, judged for collisions
void add_candidates_that_hold(const CaptureProblem& problem, const Formulation& formulation,
                              const CollisionJudge& collisions, const SearchOptions& search_options,
                              const PlannerOptions& options, AfterImpactJudge& after,
                              SearchResult& found, std::map<std::string, long>& solver_calls);

}  // namespace stillbase
