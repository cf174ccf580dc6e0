// The best of the plans for several contact features.
#pragma once

#include <vector>

#include <stillbase/planner/planner.hpp>

namespace stillbase {

/// How far a plan came.
enum class PlanQuality {
  Nothing,  ///< no configuration
  Solved,   ///< a configuration
  Arrives,  ///< and an approach to it
  Holds     ///< and the limits of the time after the impact are kept
};

struct PlanOfFeature {
  Plan plan;
  PlanQuality quality = PlanQuality::Nothing;
  double equal = 0;  ///< values that differ by less count as equal, see candidate_order()
};

/// Plans for the one feature of the problem.
PlanOfFeature plan_one_feature(const CaptureProblem& problem, const PlannerOptions& options);

/// The plan of the highest quality; among equals the one that ranks first. The candidates of all
/// features become one list ordered by rank that keeps the chosen one; a sample of a self-motion
/// comes last, as in each plan. Starts, solutions and calls are summed, and the estimate of
/// solutions not seen is that of all starts. Its status is Limit when a plan's is.
/// @pre at least one plan
Plan best_of_features(std::vector<PlanOfFeature> plans);

}  // namespace stillbase
