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
};

/// Plans for the one feature that the problem looks at.
PlanOfFeature plan_one_feature(const CaptureProblem& problem, const PlannerOptions& options);

/// The plan that came furthest; among equals the one that ranks first, as candidates do. The
/// candidates of all features become one list in the order of their rank, in which the chosen one
/// stays (a sample of a self-motion behind all others, as in each plan); starts, solutions and
/// calls are counted together, the estimate of what was not seen is that of all starts. Stopped
/// when one of them was.
/// @pre at least one plan
Plan best_of_features(std::vector<PlanOfFeature> plans);

}  // namespace stillbase
